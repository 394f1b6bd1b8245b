#include "hub/rejoin_backlog.h"

#include <algorithm>
#include <utility>

namespace vismap {
namespace {

constexpr size_t kMaxEntries = 4096;  // bounds the time of a search

size_t SizeOf(const RoutedMessage& message) {
  return message.record->size() + MessageQueue::kEntryBytes;
}

bool Replaces(const RoutedMessage& newer, const RoutedMessage& older) {
  return newer.policy == QueuePolicy::kLatest && newer.channel == older.channel &&
         newer.source == older.source;
}

}  // namespace

void RejoinBacklog::Keep(const RoutedMessage& message, const std::shared_ptr<HubClient>& sender,
                         double now) {
  if (!open(now)) return;
  const auto older = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) {
    return Replaces(message, entry.message);
  });
  if (older != entries_.end()) {
    bytes_ -= SizeOf(older->message);
    entries_.erase(older);
  }
  entries_.push_back({message, sender});
  bytes_ += SizeOf(message);
  while (bytes_ > max_bytes_ || entries_.size() > kMaxEntries) {
    DropOldest();
    ++dropped_;
  }
}

void RejoinBacklog::Replay(const HubClient* reader,
                           const std::function<bool(const std::string&)>& wanted,
                           const std::function<void(const RoutedMessage&)>& deliver) const {
  for (const Entry& entry : entries_) {
    const std::shared_ptr<HubClient> sender = entry.sender.lock();
    if (sender.get() != reader && wanted(entry.message.channel)) deliver(entry.message);
  }
}

void RejoinBacklog::Expire(double now) {
  if (open(now)) return;
  entries_.clear();
  bytes_ = 0;
}

void RejoinBacklog::DropOldest() {
  bytes_ -= SizeOf(entries_.front().message);
  entries_.pop_front();
}

}  // namespace vismap
