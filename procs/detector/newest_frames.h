#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vismap/rgbd_frame_t.hpp>

#include "wire/frame_key.h"

namespace vismap {

/// Frames that wait for a detector slower than its cameras: of each camera the one that arrived
/// last. Cameras take turns.
class NewestFrames {
 public:
  /// Frames of at most `max_cameras` wait.
  explicit NewestFrames(size_t max_cameras = 64) : max_cameras_(max_cameras) {}

  /// Takes a frame. Returns the one that will not be looked at because of it: the one of its camera
  /// that waited, or itself when too many cameras wait; none = none.
  std::optional<rgbd_frame_t> Add(const rgbd_frame_t& frame);

  /// The frame of the camera whose turn it is; none when none waits.
  std::optional<rgbd_frame_t> Next();

  bool Waits(const FrameKey& key) const;

 private:
  size_t max_cameras_;
  std::deque<rgbd_frame_t> frames_;  // one per camera, in the order of their turns
};

}  // namespace vismap
