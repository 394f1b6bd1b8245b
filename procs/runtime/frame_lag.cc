#include "runtime/frame_lag.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

namespace vismap {
namespace {

constexpr size_t kMaxCameras = 32, kMaxOpen = 4096, kMaxTold = 128;

}  // namespace

void FrameLag::Seen(const FrameKey& frame, double now) {
  if (cameras_.size() >= kMaxCameras && !cameras_.contains(frame.camera_id)) return;
  const auto [entry, first] = cameras_.try_emplace(frame.camera_id);
  Camera& camera = entry->second;
  // Frames up to the newest one are open already. An earlier time than that of the last frame that
  // is done begins another sequence.
  const bool another = camera.done && frame.utime < *camera.done;
  if (!first && !another && frame.utime <= camera.newest) return;
  if (!first && frame.utime == camera.done) return;
  camera.newest = frame.utime;
  if (camera.open.size() < kMaxOpen) {
    camera.open.emplace_back(frame.utime, now);
  } else {
    camera.open.back().first = frame.utime;
  }
}

void FrameLag::Seen(const process_status_t& status, double now) {
  const std::string_view prefix = kNewestUtimeCounter;
  for (size_t i = 0; i < status.counter_names.size(); ++i) {
    std::string_view name = status.counter_names[i];
    if (!name.starts_with(prefix)) continue;
    name.remove_prefix(prefix.size());
    int32_t camera = -1;
    const auto parsed = std::from_chars(name.data(), name.data() + name.size(), camera);
    if (parsed.ec == std::errc() && parsed.ptr == name.data() + name.size() && camera >= 0)
      SeenBy(status.source, FrameKey{CameraId{camera}, status.counter_values[i]}, now);
  }
}

void FrameLag::SeenBy(const std::string& source, const FrameKey& frame, double now) {
  const std::pair key(source, frame.camera_id);
  if (told_.size() >= kMaxTold && !told_.contains(key)) return;
  const auto [told, first] = told_.try_emplace(key, frame.utime);
  if (!first && told->second == frame.utime) return;
  if (frame.utime < told->second) cameras_.erase(frame.camera_id);  // another sequence
  told->second = frame.utime;
  Seen(frame, now);
}

void FrameLag::Done(const FrameKey& frame) {
  const auto found = cameras_.find(frame.camera_id);
  if (found == cameras_.end()) return;
  Camera& camera = found->second;
  camera.done = frame.utime;
  // Of frames that were seen before this one, those that are still open are not going to come.
  const auto last = std::find_if(camera.open.rbegin(), camera.open.rend(),
                                 [&](const auto& open) { return open.first <= frame.utime; });
  camera.open.erase(camera.open.begin(), last.base());
}

double FrameLag::DataSeconds() const {
  double most = 0;
  for (const auto& [id, camera] : cameras_) {
    if (camera.open.empty()) continue;
    const int64_t from = camera.done.value_or(camera.open.front().first);
    most = std::max(most, (static_cast<double>(camera.newest) - static_cast<double>(from)) * 1e-6);
  }
  return most;
}

double FrameLag::WaitSeconds(double now) const {
  double most = 0;
  for (const auto& [id, camera] : cameras_) {
    if (!camera.open.empty()) most = std::max(most, now - camera.open.front().second);
  }
  return most;
}

void NewestTimes::Saw(const FrameKey& frame) {
  if (cameras_.size() >= kMaxCameras && !cameras_.contains(frame.camera_id)) return;
  cameras_.insert(frame.camera_id);
  status_->SetCounter(kNewestUtimeCounter + std::to_string(Raw(frame.camera_id)), frame.utime);
}

}  // namespace vismap
