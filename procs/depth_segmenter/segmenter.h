#pragma once

#include <deque>
#include <string>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "config/process_options.h"
#include "depth_segmenter/frame_detection_join.h"
#include "runtime/main.h"
#include "runtime/peers.h"
#include "segmentation/segmentation_options.h"

namespace vismap {

/// Turns RGBD_FRAME and DETECTIONS into SEGMENTED_FRAME: one for every frame, in the order of the
/// frames. A frame that is sent again gets the same answer again.
class Segmenter {
 public:
  /// Subscribes. The context must outlive it.
  Segmenter(const DepthSegmenterOptions& options, const SegmentationStageOptions& stage,
            ProcessContext* context);

  /// Works until stop is requested.
  void Run();

 private:
  Result<void> OnFrame(const rgbd_frame_t& message);
  Result<void> OnDetections(const detections_t& message);
  bool AnswerAgain(const rgbd_frame_t& message);
  void SegmentWaiting();
  Result<segmented_frame_t> Segment(const JoinedFrame& joined);
  double Patience() const;
  void ShowState();

  DepthSegmenterOptions options_;
  SegmentationStageOptions stage_;
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
