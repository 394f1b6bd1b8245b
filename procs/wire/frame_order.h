#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>

#include "wire/frame_key.h"

namespace vismap {

/// How many frames a FrameOrder holds, and how long.
struct HoldLimits {
  size_t max_frames = 256;
  size_t max_bytes = size_t{256} << 20;
  double max_wait_s = 30;
};

/// Frames that a FrameOrder dropped. Their source may send them again.
struct DroppedFrames {
  int64_t late = 0;     ///< their predecessor did not come in time
  int64_t no_room = 0;  ///< too many, or too large ones, were held
};

/// Restores the order of frames that their source requires (rgbd_frame_t::after_utime). A frame is
/// held until its predecessor has been committed. When a frame is lost and sent again later, it is
/// therefore still integrated at its place in the sequence, and the map does not depend on the
/// loss. Held frames are bounded in number, bytes and age; a camera whose frames wait takes no room
/// from others. It has no clock of its own: callers pass the current time `now` [s].
template <typename Frame>
class FrameOrder {
 public:
  explicit FrameOrder(const HoldLimits& limits = {}) : limits_(limits) {}

  /// Adds a frame that takes `bytes` of memory. `after_utime` is the utime of its predecessor; -1 =
  /// it has none. A held frame with the same key is replaced, because its predecessor may have
  /// changed. Call Next until it returns nullopt, and then Trim.
  void Add(const FrameKey& key, int64_t after_utime, Frame frame, size_t bytes, double now) {
    Held held{key, after_utime, std::move(frame), bytes, now};
    const auto known =
        std::find_if(held_.begin(), held_.end(), [&](const Held& h) { return h.key == key; });
    bytes_ += bytes;
    if (known == held_.end()) {
      held_.push_back(std::move(held));
      return;
    }
    bytes_ -= known->bytes;
    held.since = known->since;
    *known = std::move(held);
  }

  /// Removes and returns the earliest arrived frame whose predecessor is committed; nullopt when
  /// there is none. `committed(key)` says whether that frame has been committed. Call it again
  /// after each commit, since that frame may be the predecessor of a held one.
  template <typename IsCommitted>
  std::optional<Frame> Next(const IsCommitted& committed) {
    for (auto held = held_.begin(); held != held_.end(); ++held) {
      if (held->after_utime >= 0 && !committed(FrameKey{held->key.camera_id, held->after_utime}))
        continue;
      Frame frame = std::move(held->frame);
      Drop(held);
      return frame;
    }
    return std::nullopt;
  }

  /// Drops the frames that have waited too long and, while more than the limits are held, the last
  /// frame of the camera whose frames have the most bytes.
  DroppedFrames Trim(double now) {
    DroppedFrames dropped;
    for (auto held = held_.begin(); held != held_.end();) {
      if (now - held->since < limits_.max_wait_s) {
        ++held;
        continue;
      }
      held = Drop(held);
      ++dropped.late;
    }
    for (; held_.size() > limits_.max_frames || bytes_ > limits_.max_bytes; ++dropped.no_room)
      DropLastOfLargestCamera();
    return dropped;
  }

  /// Number of frames that are held, and their memory [bytes].
  size_t held() const { return held_.size(); }
  size_t bytes() const { return bytes_; }
  /// How long the frame that arrived first has been held [s]; 0 when none is.
  double OldestSeconds(double now) const { return held_.empty() ? 0 : now - held_.front().since; }
  void Clear() {
    held_.clear();
    bytes_ = 0;
  }

 private:
  struct Held {
    FrameKey key;
    int64_t after_utime;
    Frame frame;
    size_t bytes;
    double since;  // [s]
  };
  using Place = typename std::deque<Held>::iterator;

  Place Drop(Place held) {
    bytes_ -= held->bytes;
    return held_.erase(held);
  }

  void DropLastOfLargestCamera() {
    std::map<CameraId, size_t> by_camera;
    for (const Held& held : held_) by_camera[held.key.camera_id] += held.bytes + 1;
    const auto largest =
        std::max_element(by_camera.begin(), by_camera.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    for (auto held = held_.end(); held-- != held_.begin();) {
      if (held->key.camera_id != largest->first) continue;
      Drop(held);
      return;
    }
  }

  HoldLimits limits_;
  std::deque<Held> held_;  // in order of arrival
  size_t bytes_ = 0;
};

}  // namespace vismap
