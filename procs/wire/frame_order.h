#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "wire/frame_key.h"

namespace vismap {

/// Puts frames into the order that their source asks for (rgbd_frame_t::after_utime): a frame whose
/// predecessor is not committed yet is held until it is. So a frame that was lost on its way and
/// sent again is still integrated in its place, and the map is the same. Memory is bounded: when
/// `capacity` frames are held, further ones are not taken; their source sends them again.
template <typename Frame>
class FrameOrder {
 public:
  explicit FrameOrder(size_t capacity) : capacity_(capacity) {}

  /// Takes a frame. `after_utime` = the predecessor, -1 = none. A frame that is held already is
  /// replaced, since what it waits for may have changed. False when there is no room.
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

  /// The next frame that may be integrated, oldest arrival first. `committed(key)` = that frame is
  /// done with. Ask again after each, since it may be what the next one waits for.
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
