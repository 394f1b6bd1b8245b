#include "map_server/checkpoints.h"

#include <utility>

namespace vismap {

void Checkpoints::AddIfDue(const MapSession& session) {
  if (!copies_.empty() && session.map().revision < copies_.back()->map().revision + frames_) return;
  Add(std::make_shared<const MapSession>(session));
}

void Checkpoints::Add(std::shared_ptr<const MapSession> session) {
  copies_.push_back(std::move(session));
  while (copies_.size() > 1 && (copies_.size() > kMost || bytes() > max_bytes_))
    copies_.erase(copies_.begin() + (copies_.size() > 2 ? 1 : 0));
}

void Checkpoints::DropFrom(int64_t revision) {
  while (!copies_.empty() && copies_.back()->map().revision >= revision) copies_.pop_back();
}

std::shared_ptr<const MapSession> Checkpoints::NewestBefore(int64_t revision) const {
  for (size_t i = copies_.size(); i-- > 0;) {
    if (copies_[i]->map().revision < revision) return copies_[i];
  }
  return nullptr;
}

size_t Checkpoints::bytes() const {
  size_t bytes = 0;
  for (const auto& copy : copies_) bytes += BytesOf(copy->map());
  return bytes;
}

}  // namespace vismap
