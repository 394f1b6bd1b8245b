#include "viewer/moment_maps.h"

#include <exception>
#include <utility>

#include "runtime/log.h"

namespace vismap {

MomentMaps::MomentMaps(const LogRecording* recording, MakeMap make, size_t max_bytes)
    : recording_(recording),
      make_(std::move(make)),
      max_bytes_(max_bytes),
      thread_([this] { Run(); }) {}

MomentMaps::~MomentMaps() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

MomentMaps::MapPtr MomentMaps::Find(int64_t frames) const {
  for (const auto& map : kept_) {
    if (map->map.revision == frames) return map;
  }
  return nullptr;
}

Result<MomentMaps::MapPtr> MomentMaps::Get(int64_t frames) {
  const MapPtr copy = recording_->CopyAt(frames);
  if (copy == nullptr || copy->map.revision == frames || !recording_->state().done) return copy;
  const std::lock_guard lock(mutex_);
  if (const MapPtr found = Find(frames)) return found;
  if (const auto failed = failed_.find(frames); failed != failed_.end())
    return Fail(failed->second);
  wanted_ = frames;
  changed_.notify_all();
  return MapPtr();
}

Result<MomentMaps::MapPtr> MomentMaps::Make(int64_t frames) const {
  try {
    return make_(frames, &stop_);
  } catch (const std::exception& error) {
    return Fail("the map after " + std::to_string(frames) +
                " frames could not be made because of an internal error (please report it): " +
                error.what());
  }
}

void MomentMaps::Keep(MapPtr map) {
  kept_.push_front(std::move(map));
  size_t bytes = 0, count = 0;
  for (auto kept = kept_.begin(); kept != kept_.end(); ++kept, ++count) {
    bytes += BytesOf((*kept)->map);
    if (count == 0 || (count < kMostKept && bytes <= max_bytes_)) continue;
    kept_.erase(kept, kept_.end());
    return;
  }
}

void MomentMaps::Run() {
  std::unique_lock lock(mutex_);
  while (!stop_) {
    changed_.wait(lock, [&] { return stop_ || wanted_; });
    if (stop_) return;
    const int64_t frames = *wanted_;
    lock.unlock();
    Result<MapPtr> map = Make(frames);
    lock.lock();
    if (wanted_ == frames) wanted_.reset();
    if (map) {
      Keep(std::move(*map));
    } else if (!stop_) {
      LogWarning(map.error().message);
      failed_[frames] = map.error().message;
    }
  }
}

}  // namespace vismap
