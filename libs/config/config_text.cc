#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <array>
#include <set>
#include <type_traits>

#include "base/byte_order_mark.h"
#include "base/class_names.h"
#include "base/enum_names.h"
#include "base/require.h"
#include "config/config.h"
#include "config/fields.h"
#include "options.pb.h"

namespace vismap {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// The field of a key; both are ours, so a key that is not there is a bug.
const FieldDescriptor* FieldNamed(const Message& message, const std::string& key) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(key);
  Require(field != nullptr, "every key of fields.h is a field of options.proto");
  return field;
}

/// A sensor whose noise is known, and its name in config files.
struct KnownSensor {
  const char* name;
  DepthNoiseModel (*noise)();
};
constexpr std::array<KnownSensor, 3> kKnownSensors = {
    {{"KINECT", KinectNoise}, {"REALSENSE", RealSenseNoise}, {"CLEAN", CleanNoise}}};

bool IsSet(const Message& message, const FieldDescriptor* field) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  return field->is_repeated() ? reflection.FieldSize(message, field) > 0
                              : reflection.HasField(message, field);
}

/// Reads one field, which is set, into its member. Returns what is wrong with it; empty = nothing.
class FieldReader {
 public:
  FieldReader(const Message& message, const FieldDescriptor* field)
      : message_(message), reflection_(*message.GetReflection()), field_(field) {}

  std::string Read(double& member) const {
    member = reflection_.GetDouble(message_, field_);
    return "";
  }
  std::string Read(int& member) const {
    member = reflection_.GetInt32(message_, field_);
    return "";
  }
  std::string Read(bool& member) const {
    member = reflection_.GetBool(message_, field_);
    return "";
  }
  std::string Read(std::string& member) const {
    member = reflection_.GetString(message_, field_);
    return "";
  }
  template <typename Enum>
  requires std::is_enum_v<Enum> std::string Read(Enum& member)
  const {
    for (const EnumName<Enum>& choice : NamesOf(member)) {
      if (EnumText() != choice.name) continue;
      member = choice.value;
      return "";
    }
    Require(false, "every name of an enum of options.proto is one of NamesOf");
    return "";
  }
  std::string Read(config::NoisePreset<DepthNoiseModel>& preset) const {
    for (const KnownSensor& sensor : kKnownSensors) {
      if (EnumText() == sensor.name) preset.noise = sensor.noise();
    }
    return "";
  }
  std::string Read(std::vector<std::string>& member) const {
    member.clear();
    for (int i = 0; i < size(); ++i)
      member.push_back(reflection_.GetRepeatedString(message_, field_, i));
    return "";
  }
  std::string Read(std::vector<double>& member) const {
    member.clear();
    for (int i = 0; i < size(); ++i)
      member.push_back(reflection_.GetRepeatedDouble(message_, field_, i));
    return "";
  }
  std::string Read(std::vector<ClassId>& member) const {
    member.clear();
    for (int i = 0; i < size(); ++i) {
      const std::string name = reflection_.GetRepeatedString(message_, field_, i);
      const std::optional<ClassId> class_id = ParseClass(name);
      if (!class_id || *class_id == ClassId::kUnknown)
        return "'" + name + "' is neither a COCO class nor a number in [1, 65535]";
      member.push_back(*class_id);
    }
    return "";
  }
  std::string Read(std::optional<Eigen::Vector3d>& member) const {
    if (size() != 3) return "expected three numbers, found " + std::to_string(size());
    member.emplace();
    for (int i = 0; i < 3; ++i) (*member)[i] = reflection_.GetRepeatedDouble(message_, field_, i);
    return "";
  }
  /// `member` has as many cameras as the field, with the values of the keys that they do not have.
  std::string Read(std::vector<AdapterCameraOptions>& member) const {
    std::string problems;
    for (int i = 0; i < size(); ++i) {
      const Message& values = reflection_.GetRepeatedMessage(message_, field_, i);
      const std::string problem = ReadCamera(values, member[static_cast<size_t>(i)]);
      if (!problem.empty()) problems += (problems.empty() ? "" : "; ") + problem;
    }
    return problems;
  }

 private:
  static std::string ReadCamera(const Message& values, AdapterCameraOptions& camera) {
    std::string problem;
    std::set<std::string> keys;
    config::ForEachKey(camera, "", [&](const std::string& key, auto& member) {
      keys.insert(key);
      const FieldDescriptor* field = FieldNamed(values, key);
      if (IsSet(values, field)) problem += FieldReader(values, field).Read(member);
    });
    std::vector<const FieldDescriptor*> given;
    values.GetReflection()->ListFields(values, &given);
    for (const FieldDescriptor* field : given) {
      if (!keys.contains(field->name()))
        problem = field->name() + " is no key of a camera; give it in the section itself";
    }
    return problem;
  }
  int size() const { return reflection_.FieldSize(message_, field_); }
  std::string EnumText() const { return reflection_.GetEnum(message_, field_)->name(); }

  const Message& message_;
  const google::protobuf::Reflection& reflection_;
  const FieldDescriptor* field_;
};

/// Writes a member into its field.
class FieldWriter {
 public:
  FieldWriter(Message* message, const FieldDescriptor* field)
      : message_(message), reflection_(*message->GetReflection()), field_(field) {}

  void Write(double member) const { reflection_.SetDouble(message_, field_, member); }
  void Write(int member) const { reflection_.SetInt32(message_, field_, member); }
  void Write(bool member) const { reflection_.SetBool(message_, field_, member); }
  void Write(const std::string& member) const { reflection_.SetString(message_, field_, member); }
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void Write(Enum member) const {
    const auto* value = field_->enum_type()->FindValueByName(NameOf(member));
    Require(value != nullptr, "every name of NamesOf is in the enum of options.proto");
    reflection_.SetEnum(message_, field_, value);
  }
  /// The numbers of the noise model are keys, too, so nothing is lost.
  void Write(const config::NoisePreset<const DepthNoiseModel>&) const {}
  void Write(const std::vector<std::string>& member) const {
    for (const std::string& text : member) reflection_.AddString(message_, field_, text);
  }
  void Write(const std::vector<double>& member) const {
    for (const double value : member) reflection_.AddDouble(message_, field_, value);
  }
  void Write(const std::vector<ClassId>& member) const {
    for (const ClassId class_id : member) {
      const bool named = ClassFromName(ClassName(class_id)).has_value();
      reflection_.AddString(message_, field_,
                            named ? ClassName(class_id) : std::to_string(Raw(class_id)));
    }
  }
  void Write(const std::optional<Eigen::Vector3d>& member) const {
    if (!member) return;
    for (const double coordinate : *member) reflection_.AddDouble(message_, field_, coordinate);
  }
  void Write(const std::vector<AdapterCameraOptions>& member) const {
    for (const AdapterCameraOptions& camera : member) {
      Message* values = reflection_.AddMessage(message_, field_);
      config::ForEachKey(camera, "", [&](const std::string& key, const auto& value) {
        FieldWriter(values, FieldNamed(*values, key)).Write(value);
      });
    }
  }

 private:
  Message* message_;
  const google::protobuf::Reflection& reflection_;
  const FieldDescriptor* field_;
};

/// The values of a config that the message has. Returns everything that is wrong with them.
std::vector<std::string> FromMessage(const config::Config& message, VismapConfig* config) {
  std::vector<std::string> problems;
  config::ForEachKey(
      *config, [&](const std::string& section, const std::string& key, auto& member) {
        const Message& values =
            message.GetReflection()->GetMessage(message, FieldNamed(message, section));
        const FieldDescriptor* field = FieldNamed(values, key);
        if (!IsSet(values, field)) return;
        if constexpr (std::is_same_v<decltype(member), std::vector<AdapterCameraOptions>&>) {
          const auto count = static_cast<size_t>(values.GetReflection()->FieldSize(values, field));
          member.assign(count, config->adapter);
        }
        const std::string problem = FieldReader(values, field).Read(member);
        if (!problem.empty()) problems.push_back(section + "." + key + ": " + problem);
      });
  return problems;
}

config::Config ToMessage(const VismapConfig& config) {
  config::Config message;
  config::ForEachKey(
      config, [&](const std::string& section, const std::string& key, const auto& member) {
        Message* values =
            message.GetReflection()->MutableMessage(&message, FieldNamed(message, section));
        FieldWriter(values, FieldNamed(*values, key)).Write(member);
      });
  return message;
}

/// Keeps the first error with its place.
class FirstError : public google::protobuf::io::ErrorCollector {
 public:
  explicit FirstError(std::string name) : name_(std::move(name)) {}
  void AddError(int line, int column, const std::string& message) override {
    if (!sentence_.empty()) return;
    sentence_ = name_ + ":";
    if (line >= 0) {  // counted from 0; -1 = the file as a whole
      sentence_ += std::to_string(line + 1) + ":" + std::to_string(column + 1) + ":";
    }
    sentence_ += " " + message;
  }
  const std::string& sentence() const { return sentence_; }

 private:
  std::string name_;
  std::string sentence_;
};

std::string Joined(const std::vector<std::string>& problems) {
  std::string text;
  for (const std::string& problem : problems) text += (text.empty() ? "" : "; ") + problem;
  return text;
}

}  // namespace

void DeriveOptions(VismapConfig* config) { DeriveOptions(config->surface, config); }

Result<VismapConfig> ParseConfig(const std::string& text, const std::string& name) {
  config::Config message;
  google::protobuf::TextFormat::Parser parser;
  FirstError error(name);
  parser.RecordErrorsTo(&error);
  if (!parser.ParseFromString(std::string(WithoutByteOrderMark(text)), &message)) {
    return Fail(error.sentence().empty() ? name + ": is not protobuf text" : error.sentence());
  }
  VismapConfig result;
  const std::vector<std::string> problems = FromMessage(message, &result);
  if (!problems.empty()) return Fail(name + ": " + Joined(problems));
  DeriveOptions(&result);
  return result;
}

Result<VismapConfig> ParseValidConfig(const std::string& text, const std::string& name) {
  Result<VismapConfig> parsed = ParseConfig(text, name);
  if (!parsed) return parsed;
  const std::vector<std::string> problems = Validate(*parsed);
  if (!problems.empty()) return Fail(name + ": " + Joined(problems));
  return parsed;
}

std::string PrintConfig(const VismapConfig& config) {
  std::string text;
  google::protobuf::TextFormat::Printer printer;
  printer.SetUseShortRepeatedPrimitives(true);
  const bool printed = printer.PrintToString(ToMessage(config), &text);
  Require(printed, "a config can be printed");
  return text;
}

}  // namespace vismap
