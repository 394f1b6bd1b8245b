#include "wire/channels.h"

#include <algorithm>

namespace vismap {
namespace {

constexpr std::string_view kPrefixCharacters =
    "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-/.#";
constexpr std::string_view kSeparators = "/.-#";

size_t LongestName() {
  size_t longest = 0;
  for (const Channel& channel : kAllChannels)
    longest = std::max(longest, std::string_view(channel.name).size());
  return longest;
}

bool IsOurs(std::string_view name) {
  return std::any_of(kAllChannels.begin(), kAllChannels.end(),
                     [&](const Channel& channel) { return name == channel.name; });
}

}  // namespace

Result<void> CheckChannelPrefix(std::string_view prefix) {
  const std::string text(prefix);
  if (prefix.find_first_not_of(kPrefixCharacters) != std::string_view::npos) {
    return Fail("the prefix '" + text +
                "' has other characters than letters, digits, _ - / . and #");
  }
  const size_t most = kMaxChannelName - LongestName();
  if (prefix.size() <= most) return {};
  return Fail("the prefix '" + text + "' has " + std::to_string(prefix.size()) +
              " characters, but at most " + std::to_string(most) +
              " are allowed: LCM's names of channels have at most " +
              std::to_string(kMaxChannelName));
}

std::optional<std::string> WithoutPrefix(const std::string& on_bus, const std::string& prefix) {
  if (!on_bus.starts_with(prefix)) return std::nullopt;
  return on_bus.substr(prefix.size());
}

std::string_view NameOfOurs(std::string_view on_bus, std::string_view prefix) {
  if (on_bus.starts_with(prefix) && IsOurs(on_bus.substr(prefix.size())))
    return on_bus.substr(prefix.size());
  const size_t last = on_bus.find_last_of(kSeparators);
  if (last == std::string_view::npos || !IsOurs(on_bus.substr(last + 1))) return on_bus;
  return on_bus.substr(last + 1);
}

std::string ExpressionFor(std::string_view channel) {
  constexpr std::string_view kSpecial = ".+?()[]{}|^$\\*";
  std::string expression;
  for (const char c : channel) {
    if (kSpecial.find(c) != std::string_view::npos) expression += '\\';
    expression += c;
  }
  return expression;
}

}  // namespace vismap
