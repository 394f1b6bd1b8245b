#pragma once

#include <cstddef>
#include <deque>
#include <functional>
#include <memory>

#include "hub/client.h"
#include "queueing/message_queue.h"

namespace vismap {

/// The messages that a hub has received shortly after its start. When a hub is restarted, a
/// publisher may be back before the readers are; a client that subscribes late receives what it has
/// missed from here, so that the order in which the clients come back does not matter. Of a channel
/// whose policy is kLatest, only the newest message of each source is kept.
class RejoinBacklog {
 public:
  /// Keeps messages until `seconds` after `start` (MonotonicSeconds), no more than `max_bytes`, and
  /// no more than 4096; beyond, the oldest are dropped.
  RejoinBacklog(double start, double seconds, size_t max_bytes)
      : end_(start + seconds), max_bytes_(max_bytes) {}

  /// Adds a message that `sender` has sent at time `now`.
  void Keep(const RoutedMessage& message, const std::shared_ptr<HubClient>& sender, double now);
  /// Calls `deliver` with the messages, in order, whose channel `wanted` accepts and that `reader`
  /// has not sent itself.
  void Replay(const HubClient* reader, const std::function<bool(const std::string&)>& wanted,
              const std::function<void(const RoutedMessage&)>& deliver) const;
  /// Frees all messages when the time is over.
  void Expire(double now);

  bool open(double now) const { return now < end_; }
  size_t bytes() const { return bytes_; }
  /// Messages that did not fit, since the start.
  int64_t dropped() const { return dropped_; }

 private:
  struct Entry {
    RoutedMessage message;
    std::weak_ptr<HubClient> sender;
  };
  void DropOldest();

  double end_;
  size_t max_bytes_, bytes_ = 0;
  int64_t dropped_ = 0;
  std::deque<Entry> entries_;
};

}  // namespace vismap
