#include "queueing/channel_policies.h"

#include <algorithm>
#include <array>

#include "wire/channels.h"

namespace vismap {
namespace {

constexpr std::array kLossless = {kRgbdFrameChannel, kDetectionsChannel, kSegmentedFrameChannel,
                                  kMapCommitChannel, kMapReplyChannel,   kPoseCorrectionChannel};
constexpr std::array kLatest = {kStatusChannel,     kObjectsChannel,       kOctomapChannel,
                                kOctomapRawChannel, kOctomapCoarseChannel, kOctomapInflatedChannel,
                                kNavigationChannel, kGridChannel};

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
  made.channel_prefix_ = lists.channel_prefix;
  for (const auto& [list, patterns] :
       {std::pair(&lists.lossless, &made.lossless_), std::pair(&lists.latest, &made.latest_),
        std::pair(&lists.drop_newest, &made.drop_newest_)}) {
    if (const Result<void> added = AddAll(*list, patterns); !added) {
      return tl::unexpected(added.error());
    }
  }
  return made;
}

QueuePolicy ChannelPolicies::Of(const std::string& on_bus) {
  const std::string channel(NameOfOurs(on_bus, channel_prefix_));
  const auto match = [&](ChannelPatterns& patterns) {
    return patterns.Match(on_bus) || (channel != on_bus && patterns.Match(channel));
  };
  if (match(lossless_)) return QueuePolicy::kLossless;
  if (match(latest_)) return QueuePolicy::kLatest;
  if (match(drop_newest_)) return QueuePolicy::kDropNewest;
  if (channel == kMapRequestChannel.name) return QueuePolicy::kFewPerSender;
  if (Contains(kLossless, channel)) return QueuePolicy::kLossless;
  return Contains(kLatest, channel) ? QueuePolicy::kLatest : QueuePolicy::kDropNewest;
}

}  // namespace vismap
