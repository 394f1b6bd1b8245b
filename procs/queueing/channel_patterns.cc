#include "queueing/channel_patterns.h"

#include <algorithm>
#include <utility>

namespace vismap {
namespace {

constexpr size_t kMaxKnown = 4096;
constexpr size_t kMaxKnownName = 256;  // results for longer names are not cached [characters]

}  // namespace

Result<void> ChannelPatterns::Add(const std::string& pattern) {
  Result<ChannelPattern> compiled = ChannelPattern::Compile(pattern);
  if (!compiled) return tl::unexpected(compiled.error());
  if (patterns_.size() >= kMaxPatterns || bytes_ + compiled->bytes() > kMaxBytes) {
    return Fail("there are " + std::to_string(patterns_.size()) +
                " patterns already, and one more would take more memory than is allowed");
  }
  bytes_ += compiled->bytes();
  patterns_.push_back(std::move(*compiled));
  known_.clear();
  return {};
}

void ChannelPatterns::Remove(const std::string& pattern) {
  const auto found = std::find_if(patterns_.begin(), patterns_.end(),
                                  [&](const ChannelPattern& p) { return p.text() == pattern; });
  if (found == patterns_.end()) return;
  bytes_ -= found->bytes();
  patterns_.erase(found);
  known_.clear();
}

bool ChannelPatterns::Match(const std::string& channel) {
  if (const auto known = known_.find(channel); known != known_.end()) return known->second;
  const bool match =
      std::any_of(patterns_.begin(), patterns_.end(),
                  [&](const ChannelPattern& pattern) { return pattern.Matches(channel); });
  if (channel.size() > kMaxKnownName) return match;
  if (known_.size() >= kMaxKnown) known_.clear();
  known_[channel] = match;
  return match;
}

}  // namespace vismap
