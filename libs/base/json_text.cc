#include "base/json_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/byte_order_mark.h"
#include "base/format.h"

namespace vismap {
namespace {

constexpr int kMaxNesting = 64;
constexpr size_t kMaxShown = 40;  // characters of a text

// "line 3, column 7" of the character at an offset.
std::string PlaceOf(std::string_view text, size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const size_t line_begin =
      before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  return "line " + std::to_string(line) + ", column " +
         std::to_string(before.size() - line_begin + 1);
}

// What a value of nlohmann::json needs at most, with the spare room of a growing array [bytes].
constexpr size_t kValueBytes = 48;
constexpr size_t kContainerBytes = 64;  // more than that for an array or an object
constexpr size_t kKeyBytes = 96;        // more than that for a key of an object

// Counts brackets, commas and colons outside of strings; a text that is no JSON is left to the
// parser.
Result<void> CheckSize(std::string_view text, size_t max_memory) {
  int depth = 0;
  bool in_string = false;
  size_t memory = text.size();  // for its strings
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == ',' || c == ':') {
      memory += c == ',' ? kValueBytes : kKeyBytes;
    } else if (c == '[' || c == '{') {
      memory += kContainerBytes + kValueBytes;
      if (++depth > kMaxNesting) {
        return Fail(PlaceOf(text, i) + ": nested deeper than " + std::to_string(kMaxNesting) +
                    " levels");
      }
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  if (memory <= max_memory) return {};
  return Fail("expected values that need at most " + FormatBytes(max_memory) +
              " of memory, found values for about " + FormatBytes(memory));
}

}  // namespace

template <typename Json>
Result<Json> ParseJson(std::string_view text, size_t max_memory) {
  text = WithoutByteOrderMark(text);
  if (const Result<void> checked = CheckSize(text, max_memory); !checked)
    return tl::unexpected(checked.error());
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    return Fail(PlaceOf(text, error.byte > 0 ? error.byte - 1 : 0) + ": this is not JSON");
  } catch (const nlohmann::json::exception&) {  // a number out of range
    return Fail("this is not JSON, or has numbers out of range");
  }
}

template Result<nlohmann::json> ParseJson<nlohmann::json>(std::string_view, size_t);
template Result<nlohmann::ordered_json> ParseJson<nlohmann::ordered_json>(std::string_view, size_t);

std::string DescribeJson(const nlohmann::json& value) {
  if (value.is_object()) return "an object";
  if (value.is_array()) return "an array of " + std::to_string(value.size()) + " values";
  if (!value.is_string()) return value.dump();  // a number, true, false or null
  const auto& text = value.get_ref<const std::string&>();
  std::string shown = "\"" + text.substr(0, kMaxShown);
  std::replace_if(
      shown.begin(), shown.end(), [](unsigned char c) { return c < 0x20 || c >= 0x7F; }, '?');
  return shown + (text.size() > kMaxShown ? "...\"" : "\"");
}

}  // namespace vismap
