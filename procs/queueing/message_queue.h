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

/// A message on its way from one connection to others.
struct RoutedMessage {
  std::string channel;
  SharedBytes record;  ///< as it travels: a whole tcpq record
  QueuePolicy policy = QueuePolicy::kDropNewest;
  std::string source;  ///< of kLatest: who published it; empty when it is not one of our messages
};

/// The message with its policy and source looked up.
RoutedMessage RouteMessage(const TcpqRecord& record, ChannelPolicies* policies);

/// Messages that wait for one reader, in order. Bounded: lossless ones take up to `max_bytes` (what
/// comes on top until their sender has stopped, which is asked of it by full(), is kept), the
/// others as much again. One message always fits.
class MessageQueue {
 public:
  enum class Added { kQueued, kReplacedOlder, kDropped };

  explicit MessageQueue(size_t max_bytes) : max_bytes_(max_bytes) {}

  /// `sender_waits` = whoever sends this stops sending while full(); otherwise a lossless message
  /// is dropped, too, when there is no room.
  Added Add(const RoutedMessage& message, bool sender_waits);

  /// The lossless messages have reached their limit.
  bool full() const { return lossless_bytes_ >= max_bytes_; }
  bool empty() const { return entries_.empty(); }
  size_t bytes() const { return lossless_bytes_ + other_bytes_; }
  /// Takes the oldest message out. Not of an empty queue.
  SharedBytes Pop();

 private:
  using Key = std::pair<std::string, std::string>;  // channel and source
  size_t* BytesOf(const RoutedMessage& message);

  size_t max_bytes_;
  std::list<RoutedMessage> entries_;
  std::map<Key, std::list<RoutedMessage>::iterator> latest_;  // of kLatest
  size_t lossless_bytes_ = 0, other_bytes_ = 0;
};

}  // namespace vismap
