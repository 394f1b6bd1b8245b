#include <google/protobuf/text_format.h>

#include <map>
#include <sstream>

#include "base/require.h"
#include "config/config.h"
#include "config/options_proto_text.h"
#include "options.pb.h"

namespace vismap {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

/// The comments of options.proto: those right before a message or a field. Generated code has none,
/// and protobuf's own parser is not in its run-time library.
class Comments {
 public:
  Comments() {
    std::istringstream text(config::kOptionsProtoText);
    std::string comment;
    std::string message;
    for (std::string line; std::getline(text, line);) {
      std::istringstream words(line);
      std::string first, second, third;
      words >> first >> second >> third;
      if (first == "//") {
        comment += line.substr(line.find("//") + 2) + "\n";
        continue;
      }
      if (first == "message") {
        message = second;
        comments_[message] = comment;
      } else if (first == "optional" || first == "repeated") {
        comments_[message + "." + third] = comment;
      }
      comment.clear();
    }
  }

  /// Comment lines for a message ("Grid") or a field of it ("Grid.voxel_size_m"); empty = none.
  std::string Of(const std::string& name, const std::string& indent) const {
    std::string lines;
    const auto found = comments_.find(name);
    std::istringstream text(found == comments_.end() ? "" : found->second);
    for (std::string line; std::getline(text, line);) lines += indent + "#" + line + "\n";
    return lines;
  }

 private:
  std::map<std::string, std::string> comments_;
};

/// "NAME, NAME or NAME" of an enum's values.
std::string Choices(const google::protobuf::EnumDescriptor& type) {
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) {
    if (i > 0) names += i + 1 == type.value_count() ? " or " : ", ";
    names += type.value(i)->name();
  }
  return names;
}

/// A key with its value; one that is not set as a comment.
std::string DescribeValue(const Message& section, const FieldDescriptor& field) {
  const google::protobuf::Reflection& reflection = *section.GetReflection();
  const auto value = [&](int index) {
    std::string text;
    google::protobuf::TextFormat::PrintFieldValueToString(section, &field, index, &text);
    return "  " + field.name() + ": " + text + "\n";
  };
  if (!field.is_repeated() && reflection.HasField(section, &field)) return value(-1);
  const int size = field.is_repeated() ? reflection.FieldSize(section, &field) : 0;
  if (size == 0) return "  # " + field.name() + ":\n";
  std::string text;
  for (int index = 0; index < size; ++index) text += value(index);
  return text;
}

void DescribeSection(const Message& section, const Comments& comments, std::string* text) {
  const std::string indent = "  ";
  for (int i = 0; i < section.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = section.GetDescriptor()->field(i);
    *text += comments.Of(field->containing_type()->name() + "." + field->name(), indent);
    if (field->enum_type() != nullptr) {
      *text += indent + "# " + Choices(*field->enum_type()) + ".\n";
    }
    *text += DescribeValue(section, *field);
  }
}

}  // namespace

std::string DescribeConfig(const VismapConfig& config) {
  config::Config message;
  const bool parsed = google::protobuf::TextFormat::ParseFromString(PrintConfig(config), &message);
  Require(parsed, "what is printed can be parsed");
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  const Comments comments;
  std::string text;
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor* field = message.GetDescriptor()->field(i);
    const Message& section = reflection.GetMessage(message, field);
    text += comments.Of(section.GetDescriptor()->name(), "") + field->name() + " {\n";
    DescribeSection(section, comments, &text);
    text += "}\n\n";
  }
  return text;
}

}  // namespace vismap
