#pragma once

#include <deque>
#include <string>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "config/config.h"
#include "depth_segmenter/frame_detection_join.h"
#include "runtime/main.h"
#include "runtime/peers.h"
#include "segmentation/segmentation_options.h"

namespace vismap {

struct SegmenterOptions {
  WaitForDetections detections = WaitForDetections::kAuto;
  double detection_timeout = 2.0;  ///< kAuto: how long a frame waits while a detector is alive [s]
  /// Largest number of frames that wait for detections; above it, the oldest is dropped.
  size_t max_waiting = 64;
  size_t max_cached = 32;  ///< number of results kept for frames that are sent again
  SegmentationStageOptions stage;
};

/// Segments frames: computes one SEGMENTED_FRAME from every RGBD_FRAME and its DETECTIONS, in the
/// order of the frames. For a frame that is sent again it publishes the same result again.
class Segmenter {
 public:
  /// Subscribes to RGBD_FRAME and DETECTIONS. `context` must outlive the object.
  Segmenter(const SegmenterOptions& options, ProcessContext* context);

  /// Runs until stop is requested.
  void Run();

 private:
  Result<void> OnFrame(const rgbd_frame_t& message);
  Result<void> OnDetections(const detections_t& message);
  bool RepeatAnswer(const rgbd_frame_t& message);
  void SegmentReadyFrames();
  Result<segmented_frame_t> Segment(const JoinedFrame& joined);
  double Patience() const;
  void UpdateStatus();

  SegmenterOptions options_;
  Bus& bus_;
  Status& status_;
  Peers peers_;
  FrameDetectionJoin join_;
  /// A published result.
  struct Answer {
    /// Encoded depth of the RGBD_FRAME; in `message` left-out pixels are removed.
    std::vector<uint8_t> depth;
    segmented_frame_t message;
  };
  std::deque<Answer> answers_;  // the newest ones, at most max_cached
};

}  // namespace vismap
