#pragma once

#include <cstddef>
#include <deque>
#include <limits>
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
  RecordBytes record;  ///< the whole tcpq record
  QueuePolicy policy = QueuePolicy::kDropNewest;
  /// Whose message it is, for kLatest ("" = the message has no vismap head) and kFewPerSender. A
  /// hub adds the number of the connection.
  std::string source;
};

/// Determines policy and source of a received message.
RoutedMessage RouteMessage(const TcpqRecord& record, ChannelPolicies* policies);

/// Limits of a queue, for lossless messages and again for all others.
struct QueueLimits {
  size_t max_bytes = 0;
  double max_wait =
      std::numeric_limits<double>::infinity();  ///< of the oldest lossless message [s]
};

/// The messages that wait for one reader, in order. A sender of lossless messages must stop while
/// full(); what it has sent before it stops is still accepted. A single message always fits.
class MessageQueue {
 public:
  enum class Added { kQueued, kReplacedOlder, kDropped };
  /// Memory of an entry besides its message, which counts as well, so that a queue of empty
  /// messages is bounded [bytes].
  static constexpr size_t kEntryBytes = 256;
  static constexpr int kMostOfSender = 256;  ///< messages of kFewPerSender

  explicit MessageQueue(const QueueLimits& limits) : limits_(limits) {}

  /// `sender_waits` says that the sender stops sending while full(). Otherwise a lossless message,
  /// too, is dropped when there is no room.
  Added Add(const RoutedMessage& message, bool sender_waits);

  /// Whether the lossless messages have reached one of their limits.
  bool full() const;
  bool empty() const { return entries_.empty(); }
  /// Size of all queued messages [bytes].
  size_t bytes() const { return lossless_bytes_ + other_bytes_; }
  /// How long the oldest message has waited [s]; 0 when no message waits. Messages of kLatest do
  /// not count, because they are renewed.
  double OldestSeconds() const;

  struct Entry {
    RoutedMessage message;
    double since = 0;  ///< time at which it was queued or renewed [s]
  };
  /// Removes and returns the oldest message. The queue must not be empty.
  Entry Pop();

 private:
  using Key = std::pair<std::string, std::string>;  // channel, source
  size_t* BytesOf(const RoutedMessage& message);
  std::deque<double>* TimesOf(const RoutedMessage& message);

  QueueLimits limits_;
  std::list<Entry> entries_;
  std::map<Key, std::list<Entry>::iterator> latest_;  // the queued messages of kLatest
  std::map<Key, int> few_;                            // number of queued messages of kFewPerSender
  size_t lossless_bytes_ = 0, other_bytes_ = 0;
  std::deque<double> lossless_since_,
      other_since_;  // times of queueing, ascending, without kLatest
};

}  // namespace vismap
