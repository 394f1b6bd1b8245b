#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "queueing/channel_policies.h"
#include "runtime/tcpq_records.h"

namespace vismap {

/// A received message and what is needed to queue it for other connections.
struct RoutedMessage {
  std::string channel;
  SharedBytes record;  ///< the whole tcpq record
  QueuePolicy policy = QueuePolicy::kDropNewest;
  std::string source;  ///< for kLatest: name of the publisher; "" if the message has no vismap head
};

/// Determines policy and source of a received message.
RoutedMessage RouteMessage(const TcpqRecord& record, ChannelPolicies* policies);

/// The messages that wait for one reader, in order. Lossless messages and all others may each take
/// up to `max_bytes`. A sender of lossless messages must stop while full(); what it has sent before
/// it stops is still accepted. A single message always fits.
class MessageQueue {
 public:
  enum class Added { kQueued, kReplacedOlder, kDropped };

  explicit MessageQueue(size_t max_bytes) : max_bytes_(max_bytes) {}

  /// `sender_waits` says that the sender stops sending while full(). Otherwise a lossless message,
  /// too, is dropped when there is no room.
  Added Add(const RoutedMessage& message, bool sender_waits);

  /// Whether the lossless messages have reached their limit.
  bool full() const { return lossless_bytes_ >= max_bytes_; }
  bool empty() const { return entries_.empty(); }
  /// Size of all queued messages [bytes].
  size_t bytes() const { return lossless_bytes_ + other_bytes_; }
  /// Removes and returns the oldest message. The queue must not be empty.
  SharedBytes Pop();

 private:
  using Key = std::pair<std::string, std::string>;  // channel, source
  size_t* BytesOf(const RoutedMessage& message);

  size_t max_bytes_;
  std::list<RoutedMessage> entries_;
  std::map<Key, std::list<RoutedMessage>::iterator> latest_;  // the queued messages of kLatest
  size_t lossless_bytes_ = 0, other_bytes_ = 0;
};

}  // namespace vismap
