#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "wire/frame_key.h"

namespace vismap {

/// A frame with what a detector said of it; none = no detector's word is waited for any longer.
struct JoinedFrame {
  rgbd_frame_t frame;
  std::optional<detections_t> detections;
};

/// What the join lost, and why.
struct JoinCounters {
  int64_t frames_dropped = 0;   ///< too many frames waited: the oldest was given up
  int64_t frames_repeated = 0;  ///< the same frame came again while it waited
  int64_t detections_dropped =
      0;                        ///< came for frames that never came, and made room for newer ones
  int64_t detections_late = 0;  ///< came after their frame had gone on without them
  int64_t detections_repeated = 0;  ///< the same frame's came again while they waited
  int64_t frames_without = 0;       ///< went on without detections
};

/// Brings frames together with their detections, by camera and utime, in bounded memory. Frames
/// leave in the order in which they came; detections may come before or after their frame. Does not
/// look at a clock: times [s] are passed in.
class FrameDetectionJoin {
 public:
  /// At most `capacity` frames wait, and as many detections without a frame.
  explicit FrameDetectionJoin(size_t capacity) : capacity_(capacity) {}

  void AddFrame(const rgbd_frame_t& frame, double now);
  void AddDetections(const detections_t& detections);

  /// The oldest frame, when its detections are there or when it has waited for `patience` [s] or
  /// longer (0 = it need not wait; infinity = it must). None when no frame may leave yet.
  std::optional<JoinedFrame> Next(double now, double patience);

  size_t waiting() const { return frames_.size(); }
  /// How long the oldest frame has waited [s]; 0 when none does.
  double Waited(double now) const { return frames_.empty() ? 0 : now - frames_.front().arrival; }
  const JoinCounters& counters() const { return counters_; }

 private:
  struct Waiting {
    rgbd_frame_t frame;
    double arrival;
  };
  bool IsWaiting(const FrameKey& key) const;
  void Remember(const FrameKey& key);

  size_t capacity_;
  std::deque<Waiting> frames_;                   // in order of arrival
  std::map<FrameKey, detections_t> detections_;  // whose frame has not left yet
  std::deque<FrameKey> detections_order_;        // keys of detections_, in order of arrival
  std::deque<FrameKey> gone_without_;  // frames that left without detections, the newest few
  JoinCounters counters_;
};

}  // namespace vismap
