#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "wire/frame_key.h"

namespace vismap {

/// A frame and its detections; nullopt = it does not wait for detections any longer.
struct JoinedFrame {
  rgbd_frame_t frame;
  std::optional<detections_t> detections;
  /// How long after the frame its detections came [s]; 0 = before it, or there are none.
  double detections_after_s = 0;
};

/// Counters of frames and detections that could not be paired, by reason.
struct JoinCounters {
  /// Oldest frames that were dropped since too many waited, or they had waited too long.
  int64_t frames_dropped = 0;
  int64_t frames_repeated = 0;  ///< frames that arrived again while they were waiting
  /// Detections without a frame that were dropped to make room for newer ones, or since their frame
  /// did not come in time.
  int64_t detections_dropped = 0;
  /// Detections that arrived after their frame was released without them.
  int64_t detections_late = 0;
  int64_t detections_repeated = 0;  ///< detections that arrived again while they were waiting
  int64_t frames_without = 0;       ///< frames that were released without detections
};

/// How much waits in a FrameDetectionJoin.
struct JoinLimits {
  size_t capacity = 64;  ///< of frames, and of detections
  /// Three quarters of it for frames, a quarter for detections; a single one always fits.
  size_t max_bytes = size_t{512} << 20;
  double max_wait_s = 600;
};

/// Pairs each frame with its detections, by camera and utime. Detections may arrive before or after
/// their frame. Frames are released in the order of their arrival. What waits is bounded in number,
/// bytes and age. It has no clock of its own: callers pass the current time `now` [s].
class FrameDetectionJoin {
 public:
  explicit FrameDetectionJoin(const JoinLimits& limits) : limits_(limits) {}

  void AddFrame(const rgbd_frame_t& frame, double now);
  void AddDetections(const detections_t& detections, double now);
  /// Drops what has waited for longer than allowed.
  void DropLate(double now);

  /// Removes and returns the oldest frame if its detections have arrived or if it has waited for at
  /// least `patience` [s]; otherwise nullopt. patience = 0: frames do not wait; infinity: they wait
  /// until their detections arrive.
  std::optional<JoinedFrame> Next(double now, double patience);

  /// Number of frames that wait.
  size_t waiting() const { return frames_.size(); }
  /// Memory of all that waits [bytes].
  size_t bytes() const { return frame_bytes_ + detection_bytes_; }
  /// How long the oldest frame has waited [s]; 0 when no frame waits.
  double Waited(double now) const { return frames_.empty() ? 0 : now - frames_.front().arrival; }
  const JoinCounters& counters() const { return counters_; }

 private:
  struct Waiting {
    rgbd_frame_t frame;
    double arrival;
  };
  struct WaitingDetections {
    detections_t message;
    double arrival;
  };
  bool IsWaiting(const FrameKey& key) const;
  void RememberWithout(const FrameKey& key);
  rgbd_frame_t TakeOldestFrame();
  detections_t Take(std::map<FrameKey, WaitingDetections>::iterator detections);
  void DropOldestFrame();
  void DropOldestDetections();

  JoinLimits limits_;
  std::deque<Waiting> frames_;                        // in order of arrival
  std::map<FrameKey, WaitingDetections> detections_;  // of frames that were not released yet
  std::deque<FrameKey> detections_order_;             // keys of detections_, in order of arrival
  size_t frame_bytes_ = 0, detection_bytes_ = 0;
  // Frames released without detections; the newest ones, at most capacity.
  std::deque<FrameKey> released_without_;
  JoinCounters counters_;
};

}  // namespace vismap
