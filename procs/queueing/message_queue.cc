#include "queueing/message_queue.h"

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

MessageQueue::Added MessageQueue::Add(const RoutedMessage& message, bool sender_waits) {
  size_t* bytes = BytesOf(message);
  const bool latest = message.policy == QueuePolicy::kLatest;
  if (latest) {
    // Keep the place of the older message in the queue. At the end of the queue, a message that is
    // renewed often would never be sent.
    const auto older = latest_.find({message.channel, message.source});
    if (older != latest_.end()) {
      *bytes += message.record->size() - older->second->record->size();
      older->second->record = message.record;
      return Added::kReplacedOlder;
    }
  }
  const bool keep = message.policy == QueuePolicy::kLossless && sender_waits;
  if (!keep && *bytes > 0 && *bytes + message.record->size() > max_bytes_) return Added::kDropped;
  entries_.push_back(message);
  *bytes += message.record->size();
  if (latest) latest_[{message.channel, message.source}] = std::prev(entries_.end());
  return Added::kQueued;
}

SharedBytes MessageQueue::Pop() {
  const RoutedMessage first = std::move(entries_.front());
  entries_.pop_front();
  *BytesOf(first) -= first.record->size();
  if (first.policy == QueuePolicy::kLatest) latest_.erase({first.channel, first.source});
  return first.record;
}

}  // namespace vismap
