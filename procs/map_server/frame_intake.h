#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vismap/segmented_frame_t.hpp>

#include "session/map_session.h"
#include "wire/frame_order.h"

namespace vismap {

/// The segmented frames that wait until the frame before them is in the map, see FrameOrder. A
/// frame that cannot be used is skipped, and the frames after it do not wait for it.
class FrameIntake {
 public:
  /// Frames go into this map from now on. If it is another map than before, the waiting frames are
  /// dropped: they waited for frames of the other map.
  void SetMap(const std::string& map_id);
  /// Adds a frame. False when too many frames wait already: its source must send it again.
  bool Add(const segmented_frame_t& message);
  /// The next frame that may be integrated into the map of the session, or nullopt. Call it again
  /// after each frame, which may be what others wait for.
  std::optional<segmented_frame_t> Next(const MapSession& session);
  /// The frame is not going to be integrated.
  void Skip(const FrameKey& frame);
  size_t waiting() const { return order_.held(); }

 private:
  std::string map_id_;
  FrameOrder<segmented_frame_t> order_{256};  // at most so many frames wait
  std::set<FrameKey> skipped_;
};

}  // namespace vismap
