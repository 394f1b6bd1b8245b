#include "adapter/native_module.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <optional>

#include "runtime/clock.h"

namespace vismap {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kStdinConfig = "--stdin-config";
constexpr size_t kMaxLine = size_t{1} << 20;  // [bytes]

std::string OptionNamed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return "--" + name;
}

bool HasOption(const std::vector<std::string>& words, const std::string& option) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return word == option || word.starts_with(option + "=");
  });
}

// A value as DimOS writes it on a command line; nullopt = it has no such form.
std::optional<std::string> TextOf(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "true" : "false";
  if (value.is_number()) return value.dump();
  if (!value.is_array()) return std::nullopt;
  std::string list;
  for (const Json& item : value) {
    const std::optional<std::string> text = item.is_array() ? std::nullopt : TextOf(item);
    if (!text) return std::nullopt;
    list += (list.empty() ? "" : ",") + *text;
  }
  return list;
}

Result<void> AddMembers(const Json& json, const char* name, std::vector<std::string>* words) {
  const auto found = json.find(name);
  if (found == json.end() || found->is_null()) return {};
  if (!found->is_object())
    return Fail("the standard input: '" + std::string(name) + "' is no object");
  for (const auto& [key, value] : found->items()) {
    const std::string option = OptionNamed(key);
    if (value.is_null() || HasOption(*words, option)) continue;
    const std::optional<std::string> text = TextOf(value);
    if (!text) {
      return Fail("the standard input: '" + key + "' in '" + name +
                  "' is neither a text, a number, true, false nor a list of them");
    }
    words->push_back(option + "=" + *text);
  }
  return {};
}

}  // namespace

std::vector<std::string> WithDashes(const std::vector<std::string>& words) {
  std::vector<std::string> result = words;
  for (std::string& word : result) {
    if (!word.starts_with("--")) continue;
    const size_t end = std::min(word.find('='), word.size());
    std::replace(word.begin() + 2, word.begin() + static_cast<std::ptrdiff_t>(end), '_', '-');
  }
  return result;
}

bool WantsStdinConfig(const std::vector<std::string>& words) {
  for (size_t i = 0; i < words.size(); ++i) {
    if (words[i] == std::string(kStdinConfig) + "=true") return true;
    if (words[i] == kStdinConfig && i + 1 < words.size() && words[i + 1] == "true") return true;
  }
  return false;
}

Result<std::string> ReadStdinLine(double timeout) {
  const double deadline = MonotonicSeconds() + timeout;
  std::string line;
  while (line.size() < kMaxLine) {
    pollfd waiting{STDIN_FILENO, POLLIN, 0};
    const double left = deadline - MonotonicSeconds();
    if (left <= 0 || poll(&waiting, 1, static_cast<int>(left * 1000) + 1) == 0) break;
    char character = 0;
    if (read(STDIN_FILENO, &character, 1) != 1 || character == '\n') return line;
    line += character;
  }
  return Fail("no whole line came on the standard input (--stdin-config)");
}

Result<std::vector<std::string>> WithStdinConfig(std::vector<std::string> words,
                                                 const std::string& line) {
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object())
    return Fail("the standard input (--stdin-config): expected one line with a JSON object");
  for (const char* name : {"topics", "config"}) {
    if (const Result<void> added = AddMembers(json, name, &words); !added)
      return tl::unexpected(added.error());
  }
  return words;
}

std::string TransportProblem(const std::string& transport) {
  std::string lower = transport;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower.empty() || lower.find("lcm") != std::string::npos) return "";
  return "DIMOS_TRANSPORT is '" + transport +
         "', but vismap-adapter reads the messages of DimOS from LCM; start DimOS with "
         "DIMOS_TRANSPORT=lcm";
}

}  // namespace vismap
