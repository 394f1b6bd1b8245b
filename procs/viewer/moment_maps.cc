#include "viewer/moment_maps.h"

#include <utility>

namespace vismap {

MomentMaps::MomentMaps(const LogSource* source) : source_(source), thread_([this] { Run(); }) {}

MomentMaps::~MomentMaps() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

std::shared_ptr<const LoadedMap> MomentMaps::Find(int64_t frames) const {
  for (const auto& map : kept_) {
    if (map->map.revision == frames) return map;
  }
  return nullptr;
}

std::shared_ptr<const LoadedMap> MomentMaps::Get(int64_t frames) {
  const std::shared_ptr<const LoadedMap> copy = source_->recording().CopyAt(frames);
  if (copy == nullptr || copy->map.revision == frames || !source_->recording().state().done)
    return copy;
  const std::lock_guard lock(mutex_);
  if (auto found = Find(frames)) return found;
  wanted_ = frames;
  changed_.notify_all();
  return nullptr;
}

void MomentMaps::Run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    changed_.wait(lock, [&] { return stop_ || wanted_; });
    if (stop_) return;
    const int64_t frames = *wanted_;
    lock.unlock();
    std::shared_ptr<const LoadedMap> map = source_->MapAfter(frames, &stop_);
    lock.lock();
    if (wanted_ == frames) wanted_.reset();
    if (map == nullptr) continue;
    kept_.push_front(std::move(map));
    if (kept_.size() > kMostKept) kept_.pop_back();
  }
}

}  // namespace vismap
