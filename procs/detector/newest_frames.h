#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vismap/rgbd_frame_t.hpp>

#include "wire/frame_key.h"

namespace vismap {

/// The frames that wait for a detector that is slower than the cameras: the newest frame of each
/// camera. The cameras take turns.
class NewestFrames {
 public:
  /// Frames of at most `max_cameras` cameras wait, with at most `max_bytes` in all.
  explicit NewestFrames(size_t max_cameras = 64, size_t max_bytes = size_t{256} << 20)
      : max_cameras_(max_cameras), max_bytes_(max_bytes) {}

  /// Adds a frame. Returns the frame that is skipped because of it: the waiting one of the same
  /// camera, or `frame` itself when there is no room; nullopt when no frame is skipped.
  std::optional<rgbd_frame_t> Add(const rgbd_frame_t& frame);

  /// Removes and returns the frame of the camera whose turn it is; nullopt when no frame waits.
  std::optional<rgbd_frame_t> Next();

  /// Whether this frame waits.
  bool Waits(const FrameKey& key) const;

 private:
  size_t max_cameras_, max_bytes_;
  std::deque<rgbd_frame_t> frames_;  // one per camera, in the order of their turns
};

}  // namespace vismap
