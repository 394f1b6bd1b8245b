#include "queueing/channel_patterns.h"

#include <algorithm>

namespace vismap {
namespace {

constexpr size_t kMaxPatterns = 1024;
constexpr size_t kMaxKnown = 4096;

// Match in polynomial time, so that a pattern from the bus cannot stop the hub.
constexpr auto kRegexFlags =
    std::regex::ECMAScript | std::regex::nosubs | std::regex_constants::__polynomial;

}  // namespace

Result<void> ChannelPatterns::Add(const std::string& pattern) {
  if (entries_.size() >= kMaxPatterns)
    return Fail("there are already " + std::to_string(kMaxPatterns) + " patterns");
  try {
    entries_.push_back({pattern, std::regex(pattern, kRegexFlags)});
  } catch (const std::regex_error& error) {
    return Fail("pattern '" + pattern + "': " + error.what());
  }
  known_.clear();
  return {};
}

void ChannelPatterns::Remove(const std::string& pattern) {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& e) { return e.pattern == pattern; });
  if (found != entries_.end()) entries_.erase(found);
  known_.clear();
}

bool ChannelPatterns::Match(const std::string& channel) {
  if (const auto known = known_.find(channel); known != known_.end()) return known->second;
  if (known_.size() >= kMaxKnown) known_.clear();
  const bool match = std::any_of(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return std::regex_match(channel, entry.regex);
  });
  known_[channel] = match;
  return match;
}

}  // namespace vismap
