#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "queueing/channel_patterns.h"

namespace vismap {

/// What becomes of a channel's messages while their reader is slow.
enum class QueuePolicy {
  kLossless,    ///< all are kept; when the queue is full, whoever publishes them has to wait
  kLatest,      ///< a newer one of the same source takes the place of one that waits
  kDropNewest,  ///< all are kept; when the queue is full, new ones are dropped
};

/// Patterns of the channels that are treated otherwise than by default.
struct PolicyLists {
  std::vector<std::string> lossless, latest, drop_newest;
};

/// The policy of every channel. By default what a map is made of is lossless (frames, detections,
/// segmented frames, commits, requests and replies), of what is complete in itself only the latest
/// counts (status, objects, octrees), and everything else (map and mesh deltas, whose readers ask
/// for what they missed; channels that are not ours) must not hold up anybody.
class ChannelPolicies {
 public:
  /// Fails when a pattern is no regular expression. A channel of several lists is treated by the
  /// first of them.
  static Result<ChannelPolicies> Make(const PolicyLists& lists);

  QueuePolicy Of(const std::string& channel);

 private:
  ChannelPatterns lossless_, latest_, drop_newest_;
};

}  // namespace vismap
