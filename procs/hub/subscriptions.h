#pragma once

#include <list>
#include <regex>
#include <string>
#include <unordered_map>

#include "base/result.h"

namespace vismap {

/// The channels that one client wants: regular expressions that must match the whole name, as LCM
/// has them.
class Subscriptions {
 public:
  /// Fails when `pattern` is no regular expression, or there are too many.
  Result<void> Add(const std::string& pattern);
  /// Takes back one Add of the same pattern, if there is one.
  void Remove(const std::string& pattern);
  bool Wants(const std::string& channel);

 private:
  struct Entry {
    std::string pattern;
    std::regex regex;
  };
  std::list<Entry> entries_;
  std::unordered_map<std::string, bool> known_;  // answers so far
};

}  // namespace vismap
