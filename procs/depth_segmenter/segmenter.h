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
  double detection_timeout = 2.0;  ///< kAuto: patience with a detector that is alive [s]
  size_t max_waiting = 64;  ///< frames that wait for detections; beyond, the oldest is given up
  size_t max_cached = 32;   ///< results kept for frames that are sent again
  SegmentationStageOptions stage;
};

/// Turns RGBD_FRAME and DETECTIONS into SEGMENTED_FRAME: one for every frame, in the order of the
/// frames. A frame that is sent again gets the same answer again.
class Segmenter {
 public:
  /// Subscribes. The context must outlive it.
  Segmenter(const SegmenterOptions& options, ProcessContext* context);

  /// Works until stop is requested.
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
  /// What a frame was answered with.
  struct Answer {
    std::vector<uint8_t> depth;  ///< as the frame came; the answer's may lack what was left out
    segmented_frame_t message;
  };
  std::deque<Answer> answers_;  // the newest few
};

}  // namespace vismap
