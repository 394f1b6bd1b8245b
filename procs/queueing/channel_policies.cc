#include "queueing/channel_policies.h"

#include <algorithm>
#include <array>

#include "wire/channels.h"

namespace vismap {
namespace {

constexpr std::array kLossless = {kRgbdFrameChannel, kDetectionsChannel, kSegmentedFrameChannel,
                                  kMapCommitChannel, kMapRequestChannel, kMapReplyChannel};
constexpr std::array kLatest = {kStatusChannel,     kObjectsChannel,       kOctomapChannel,
                                kOctomapRawChannel, kOctomapCoarseChannel, kOctomapInflatedChannel,
                                kNavigationChannel};

template <typename Channels>
bool Contains(const Channels& channels, const std::string& name) {
  return std::any_of(channels.begin(), channels.end(),
                     [&](const Channel& channel) { return name == channel.name; });
}

Result<void> AddAll(const std::vector<std::string>& list, ChannelPatterns* patterns) {
  for (const std::string& pattern : list) {
    if (Result<void> added = patterns->Add(pattern); !added) return added;
  }
  return {};
}

}  // namespace

Result<ChannelPolicies> ChannelPolicies::Make(const PolicyLists& lists) {
  ChannelPolicies made;
  for (const auto& [list, patterns] :
       {std::pair(&lists.lossless, &made.lossless_), std::pair(&lists.latest, &made.latest_),
        std::pair(&lists.drop_newest, &made.drop_newest_)}) {
    if (const Result<void> added = AddAll(*list, patterns); !added) {
      return tl::unexpected(added.error());
    }
  }
  return made;
}

QueuePolicy ChannelPolicies::Of(const std::string& channel) {
  if (lossless_.Match(channel)) return QueuePolicy::kLossless;
  if (latest_.Match(channel)) return QueuePolicy::kLatest;
  if (drop_newest_.Match(channel)) return QueuePolicy::kDropNewest;
  if (Contains(kLossless, channel)) return QueuePolicy::kLossless;
  return Contains(kLatest, channel) ? QueuePolicy::kLatest : QueuePolicy::kDropNewest;
}

}  // namespace vismap
