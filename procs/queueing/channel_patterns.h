#pragma once

#include <list>
#include <string>
#include <unordered_map>

#include "base/result.h"
#include "queueing/channel_pattern.h"

namespace vismap {

/// A set of channels, given by patterns (see ChannelPattern).
class ChannelPatterns {
 public:
  /// Bounds of one set: what one client of a hub can use.
  static constexpr size_t kMaxPatterns = 1024;
  static constexpr size_t kMaxBytes = size_t{8} << 20;  ///< of the patterns, see ChannelPattern

  /// Fails when the pattern cannot be used, or when the set would grow beyond its bounds.
  Result<void> Add(const std::string& pattern);
  /// Removes one pattern that equals `pattern`, if there is one.
  void Remove(const std::string& pattern);
  /// Whether a pattern matches this channel.
  bool Match(const std::string& channel);

  size_t bytes() const { return bytes_; }  ///< an upper bound of the memory of the patterns

 private:
  std::list<ChannelPattern> patterns_;
  size_t bytes_ = 0;
  std::unordered_map<std::string, bool> known_;  // cached results of Match
};

}  // namespace vismap
