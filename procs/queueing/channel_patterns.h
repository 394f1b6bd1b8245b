#pragma once

#include <list>
#include <regex>
#include <string>
#include <unordered_map>

#include "base/result.h"

namespace vismap {

/// A set of channels, given by regular expressions. As in LCM's subscriptions, a pattern must match
/// the whole name of a channel.
class ChannelPatterns {
 public:
  /// Fails when `pattern` is not a valid regular expression, or when there are too many patterns.
  Result<void> Add(const std::string& pattern);
  /// Removes one pattern that equals `pattern`, if there is one.
  void Remove(const std::string& pattern);
  /// Whether a pattern matches this channel.
  bool Match(const std::string& channel);

 private:
  struct Entry {
    std::string pattern;
    std::regex regex;
  };
  std::list<Entry> entries_;
  std::unordered_map<std::string, bool> known_;  // cached results of Match, by channel
};

}  // namespace vismap
