#pragma once

#include <cstddef>
#include <deque>
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
  explicit FrameIntake(const HoldLimits& limits = {}) : order_(limits) {}

  /// Frames go into this map from now on. If it is another map than before, the waiting frames are
  /// dropped: they waited for frames of the other map. Returns whether it is another one.
  bool SetMap(const std::string& map_id);
  /// Adds a frame at time `now` [s].
  void Add(const segmented_frame_t& message, double now);
  /// The next frame that may be integrated into the map of the session, or nullopt. Call it again
  /// after each frame, which may be what others wait for.
  std::optional<segmented_frame_t> Next(const MapSession& session);
  /// Drops frames beyond the limits. Call it when Next has returned nullopt, and now and then.
  DroppedFrames Trim(double now) { return order_.Trim(now); }
  /// The frame is not going to be integrated.
  void Skip(const FrameKey& frame);
  size_t waiting() const { return order_.held(); }
  size_t waiting_bytes() const { return order_.bytes(); }
  double OldestSeconds(double now) const { return order_.OldestSeconds(now); }

 private:
  std::string map_id_;
  FrameOrder<segmented_frame_t> order_;
  std::set<FrameKey> skipped_;          // the newest ones
  std::deque<FrameKey> skipped_order_;  // in the order of Skip
};

/// The memory that a message takes while it waits [bytes].
size_t BytesOf(const segmented_frame_t& message);

}  // namespace vismap
