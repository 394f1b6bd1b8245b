#include "queueing/message_queue.h"

#include <algorithm>
#include <cmath>

#include "runtime/clock.h"
#include "wire/envelope.h"

namespace vismap {

RoutedMessage RouteMessage(const TcpqRecord& record, ChannelPolicies* policies) {
  RoutedMessage message{record.name, record.bytes, policies->Of(record.name), ""};
  if (message.policy != QueuePolicy::kLatest) return message;
  if (const std::optional<MessageHead> head = PeekHead(record.data()))
    message.source = head->source;
  return message;
}

size_t* MessageQueue::BytesOf(const RoutedMessage& message) {
  return message.policy == QueuePolicy::kLossless ? &lossless_bytes_ : &other_bytes_;
}

std::deque<double>* MessageQueue::TimesOf(const RoutedMessage& message) {
  return message.policy == QueuePolicy::kLossless ? &lossless_since_ : &other_since_;
}

bool MessageQueue::full() const {
  const bool late =
      !lossless_since_.empty() && MonotonicSeconds() - lossless_since_.front() >= limits_.max_wait;
  return late || lossless_bytes_ >= limits_.max_bytes;
}

double MessageQueue::OldestSeconds() const {
  double since = std::numeric_limits<double>::infinity();
  if (!lossless_since_.empty()) since = lossless_since_.front();
  if (!other_since_.empty()) since = std::min(since, other_since_.front());
  return std::isfinite(since) ? MonotonicSeconds() - since : 0;
}

MessageQueue::Added MessageQueue::Add(const RoutedMessage& message, bool sender_waits) {
  size_t* bytes = BytesOf(message);
  const bool latest = message.policy == QueuePolicy::kLatest;
  const Key key(message.channel, message.source);
  const size_t size = message.record->size() + kEntryBytes;
  if (latest) {
    // Keep the place of the older message in the queue. At the end of the queue, a message that is
    // renewed often would never be sent.
    const auto older = latest_.find(key);
    if (older != latest_.end()) {
      Entry& entry = *older->second;
      *bytes += message.record->size() - entry.message.record->size();
      entry.message.record = message.record;
      entry.since = MonotonicSeconds();
      return Added::kReplacedOlder;
    }
  }
  const bool few = message.policy == QueuePolicy::kFewPerSender;
  if (const auto waiting = few_.find(key);
      few && waiting != few_.end() && waiting->second >= kMostOfSender)
    return Added::kDropped;
  const bool lossless = message.policy == QueuePolicy::kLossless;
  const bool no_room = *bytes > 0 && *bytes + size > limits_.max_bytes;
  if (!(lossless && sender_waits) && (no_room || (lossless && full()))) return Added::kDropped;
  entries_.push_back({message, MonotonicSeconds()});
  *bytes += size;
  if (latest) {
    latest_[key] = std::prev(entries_.end());
  } else {
    TimesOf(message)->push_back(entries_.back().since);
  }
  if (few) ++few_[key];
  return Added::kQueued;
}

MessageQueue::Entry MessageQueue::Pop() {
  Entry first = std::move(entries_.front());
  entries_.pop_front();
  *BytesOf(first.message) -= first.message.record->size() + kEntryBytes;
  if (first.message.policy == QueuePolicy::kLatest) {
    latest_.erase({first.message.channel, first.message.source});
  } else {
    TimesOf(first.message)->pop_front();
  }
  if (first.message.policy == QueuePolicy::kFewPerSender) {
    const auto waiting = few_.find({first.message.channel, first.message.source});
    if (--waiting->second == 0) few_.erase(waiting);
  }
  return first;
}

}  // namespace vismap
