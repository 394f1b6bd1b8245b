#pragma once

#include <list>
#include <regex>
#include <string>
#include <unordered_map>

#include "base/result.h"

namespace vismap {

/// A set of channels: regular expressions that must match the whole name, as LCM's subscriptions
/// have it.
class ChannelPatterns {
 public:
  /// Fails when `pattern` is no regular expression, or there are too many.
  Result<void> Add(const std::string& pattern);
  /// Takes back one Add of the same pattern, if there is one.
  void Remove(const std::string& pattern);
  bool Match(const std::string& channel);

 private:
  struct Entry {
    std::string pattern;
    std::regex regex;
  };
  std::list<Entry> entries_;
  std::unordered_map<std::string, bool> known_;  // answers so far
};

}  // namespace vismap
