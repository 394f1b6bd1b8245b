#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "queueing/channel_patterns.h"

namespace vismap {

/// What happens to the messages of a channel when a reader is too slow.
enum class QueuePolicy {
  kLossless,    ///< no message is dropped: when the queue is full, the publisher has to wait
  kLatest,      ///< a new message replaces the waiting one of the same source
  kDropNewest,  ///< when the queue is full, new messages are dropped
  /// At most MessageQueue::kMostOfSender messages of one sender wait; more are dropped. For
  /// requests, which their senders repeat: one that sends too many does not delay the others.
  kFewPerSender,
};

/// Patterns of the channels whose policy differs from the default. They match the name on the bus,
/// or that of ours without its prefix.
struct PolicyLists {
  std::vector<std::string> lossless, latest, drop_newest;
  std::string channel_prefix = {};  ///< see NameOfOurs
};

/// The queue policy of every channel. The defaults are: kLossless for the data from which the map
/// is built (frames, detections, segmented frames, commits) and for replies; kFewPerSender for
/// requests; kLatest
/// for messages that each replace the previous one (status, objects, octrees); kDropNewest for all
/// others, so that their readers never delay a publisher. Among the others are map and mesh deltas,
/// whose readers request missed updates again.
class ChannelPolicies {
 public:
  /// Fails when a pattern is not a valid regular expression. If a channel matches several lists,
  /// the first one counts.
  static Result<ChannelPolicies> Make(const PolicyLists& lists);

  QueuePolicy Of(const std::string& on_bus);

 private:
  std::string channel_prefix_;
  ChannelPatterns lossless_, latest_, drop_newest_;
};

}  // namespace vismap
