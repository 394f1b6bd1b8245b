#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "wire/frame_key.h"

namespace vismap {

/// Restores the order of frames that their source requires (rgbd_frame_t::after_utime). A frame is
/// held until its predecessor has been committed. When a frame is lost and sent again later, it is
/// therefore still integrated at its place in the sequence, and the map does not depend on the
/// loss. At most `capacity` frames are held; further frames are rejected, and their source sends
/// them again.
template <typename Frame>
class FrameOrder {
 public:
  explicit FrameOrder(size_t capacity) : capacity_(capacity) {}

  /// Adds a frame. `after_utime` is the utime of its predecessor; -1 = it has none. A held frame
  /// with the same key is replaced, because its predecessor may have changed. Returns false when
  /// `capacity` frames are held.
  bool Add(const FrameKey& key, int64_t after_utime, Frame frame) {
    const auto known =
        std::find_if(held_.begin(), held_.end(), [&](const Held& held) { return held.key == key; });
    if (known != held_.end()) {
      *known = {key, after_utime, std::move(frame)};
      return true;
    }
    if (held_.size() >= capacity_) return false;
    held_.push_back({key, after_utime, std::move(frame)});
    return true;
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
      held_.erase(held);
      return frame;
    }
    return std::nullopt;
  }

  /// Number of frames that are held.
  size_t held() const { return held_.size(); }
  void Clear() { held_.clear(); }

 private:
  struct Held {
    FrameKey key;
    int64_t after_utime;
    Frame frame;
  };
  size_t capacity_;
  std::deque<Held> held_;  // in order of arrival
};

}  // namespace vismap
