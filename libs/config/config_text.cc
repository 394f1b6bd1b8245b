#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <functional>
#include <type_traits>

#include "base/class_names.h"
#include "base/file.h"
#include "base/require.h"
#include "config/bindings.h"
#include "config/config.h"
#include "options.pb.h"

namespace vismap {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// The field that a binding names; both are ours, so a name that is not there is a bug.
const FieldDescriptor* FieldOf(const Message& message, const char* key) {
  const FieldDescriptor* field = message.GetDescriptor()->FindFieldByName(key);
  Require(field != nullptr, "every binding names a field of options.proto");
  return field;
}

/// Binder that moves the fields that are present into the structs.
class Reader {
 public:
  Reader(const Message& message, std::string path, std::vector<std::string>* problems)
      : message_(message), path_(std::move(path)), problems_(problems) {}

  void Value(const char* key, std::vector<std::string>& member) {
    const FieldDescriptor* field = FieldOf(message_, key);
    const int size = reflection().FieldSize(message_, field);
    if (size > 0) member.clear();
    for (int i = 0; i < size; ++i) {
      member.push_back(reflection().GetRepeatedString(message_, field, i));
    }
  }

  template <typename T>
  void Value(const char* key, T& member) {
    const FieldDescriptor* field = FieldOf(message_, key);
    if (!reflection().HasField(message_, field)) return;
    if constexpr (std::is_same_v<T, double>) {
      member = reflection().GetDouble(message_, field);
    } else if constexpr (std::is_same_v<T, int>) {
      member = reflection().GetInt32(message_, field);
    } else if constexpr (std::is_same_v<T, bool>) {
      member = reflection().GetBool(message_, field);
    } else if constexpr (std::is_same_v<T, std::string>) {
      member = reflection().GetString(message_, field);
    } else {
      static_assert(std::is_enum_v<T>);
      member = static_cast<T>(reflection().GetEnumValue(message_, field));
    }
  }

  void Classes(const char* key, std::vector<ClassId>& member) {
    std::vector<std::string> names;
    Value(key, names);
    if (!names.empty()) member.clear();
    for (const std::string& name : names) {
      const std::optional<ClassId> class_id = ParseClass(name);
      if (!class_id || *class_id == ClassId::kUnknown) {
        problems_->push_back(path_ + key + ": '" + name +
                             "' is neither a COCO class nor a number in [1, 65535]");
      } else {
        member.push_back(*class_id);
      }
    }
  }

  void Direction(const char* key, std::optional<Eigen::Vector3d>& member) {
    const FieldDescriptor* field = FieldOf(message_, key);
    const int size = reflection().FieldSize(message_, field);
    if (size == 0) return;
    if (size != 3) {
      problems_->push_back(path_ + key + ": expected three numbers, found " + std::to_string(size));
      return;
    }
    member.emplace();
    for (int i = 0; i < 3; ++i) {
      (*member)[i] = reflection().GetRepeatedDouble(message_, field, i);
    }
  }

  void Sensor(const char* key, DepthNoiseModel& member) {
    const FieldDescriptor* field = FieldOf(message_, key);
    if (!reflection().HasField(message_, field)) return;
    switch (reflection().GetEnumValue(message_, field)) {
      case config::Surface::REALSENSE:
        member = RealSenseNoise();
        break;
      case config::Surface::CLEAN:
        member = CleanNoise();
        break;
      default:
        member = KinectNoise();
    }
  }

  void Section(const char* key, const std::function<void(Reader&)>& body) {
    const FieldDescriptor* field = FieldOf(message_, key);
    Reader section(reflection().GetMessage(message_, field), path_ + key + ".", problems_);
    body(section);
  }

 private:
  const google::protobuf::Reflection& reflection() const { return *message_.GetReflection(); }

  const Message& message_;
  std::string path_;
  std::vector<std::string>* problems_;
};

/// Binder that sets every field from the structs.
class Writer {
 public:
  explicit Writer(Message* message) : message_(message) {}

  void Value(const char* key, const std::vector<std::string>& member) {
    for (const std::string& text : member) {
      reflection().AddString(message_, FieldOf(*message_, key), text);
    }
  }

  template <typename T>
  void Value(const char* key, const T& member) {
    const FieldDescriptor* field = FieldOf(*message_, key);
    if constexpr (std::is_same_v<T, double>) {
      reflection().SetDouble(message_, field, member);
    } else if constexpr (std::is_same_v<T, int>) {
      reflection().SetInt32(message_, field, member);
    } else if constexpr (std::is_same_v<T, bool>) {
      reflection().SetBool(message_, field, member);
    } else if constexpr (std::is_same_v<T, std::string>) {
      reflection().SetString(message_, field, member);
    } else {
      static_assert(std::is_enum_v<T>);
      reflection().SetEnumValue(message_, field, static_cast<int>(member));
    }
  }

  void Classes(const char* key, const std::vector<ClassId>& member) {
    for (const ClassId class_id : member) {
      const bool named = ClassFromName(ClassName(class_id)).has_value();
      reflection().AddString(message_, FieldOf(*message_, key),
                             named ? ClassName(class_id) : std::to_string(Raw(class_id)));
    }
  }

  void Direction(const char* key, const std::optional<Eigen::Vector3d>& member) {
    if (!member) return;
    for (const double coordinate : *member) {
      reflection().AddDouble(message_, FieldOf(*message_, key), coordinate);
    }
  }

  /// The numbers of the model are written, so that nothing is lost.
  void Sensor(const char*, const DepthNoiseModel&) {}

  void Section(const char* key, const std::function<void(Writer&)>& body) {
    Writer section(reflection().MutableMessage(message_, FieldOf(*message_, key)));
    body(section);
  }

 private:
  const google::protobuf::Reflection& reflection() const { return *message_->GetReflection(); }

  Message* message_;
};

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

config::Config ToMessage(const VismapConfig& config) {
  config::Config message;
  Writer writer(&message);
  VismapConfig copy = config;  // bindings are made for reading, too
  config::BindConfig(writer, copy);
  return message;
}

}  // namespace

Result<VismapConfig> ParseConfig(const std::string& text, const std::string& name) {
  config::Config message;
  google::protobuf::TextFormat::Parser parser;
  FirstError error(name);
  parser.RecordErrorsTo(&error);
  if (!parser.ParseFromString(text, &message)) {
    return Fail(error.sentence().empty() ? name + ": is not protobuf text" : error.sentence());
  }
  VismapConfig result;
  std::vector<std::string> problems;
  Reader reader(message, "", &problems);
  config::BindConfig(reader, result);
  if (!problems.empty()) return Fail(name + ": " + Joined(problems));
  result.association.min_range_m = result.integration.min_range_m;
  result.association.max_range_m = result.integration.max_range_m;
  result.integration.noise = result.segmentation.surface.noise;
  return result;
}

Result<VismapConfig> ParseValidConfig(const std::string& text, const std::string& name) {
  Result<VismapConfig> parsed = ParseConfig(text, name);
  if (!parsed) return parsed;
  const std::vector<std::string> problems = Validate(*parsed);
  if (!problems.empty()) return Fail(name + ": " + Joined(problems));
  return parsed;
}

Result<VismapConfig> LoadConfig(const std::string& path) {
  constexpr uint64_t kMaxBytes = 1 << 20;
  const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMaxBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  return ParseValidConfig(std::string(bytes->begin(), bytes->end()), path);
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
