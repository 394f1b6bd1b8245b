#pragma once

#include <deque>
#include <set>
#include <string>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "base/reason_counts.h"
#include "config/process_options.h"
#include "depth_segmenter/frame_detection_join.h"
#include "geometry/frame.h"
#include "geometry/saturated_depth.h"
#include "plausibility/depth_check.h"
#include "rectify/rectifier.h"
#include "runtime/frame_lag.h"
#include "runtime/main.h"
#include "runtime/peers.h"
#include "segmentation/segmentation_options.h"
#include "wire/camera_sources.h"
#include "wire/frame_key.h"

namespace vismap {

/// Segments frames: computes one SEGMENTED_FRAME from every RGBD_FRAME and its DETECTIONS, in the
/// order of the frames. For a frame that is sent again it publishes the same result again. With
/// Overload::kNewest it drops frames when newer ones are ready. STATUS tells when hardly any depth
/// lies in segments.
class Segmenter {
 public:
  /// Subscribes to RGBD_FRAME and DETECTIONS. `context` must outlive the object.
  Segmenter(const DepthSegmenterOptions& options, const SegmentationStageOptions& stage,
            ProcessContext* context);

  /// Runs until stop is requested.
  void Run();

 private:
  Result<void> OnFrame(const rgbd_frame_t& message);
  Result<void> OnDetections(const detections_t& message);
  bool RepeatAnswer(const rgbd_frame_t& message);
  void HandleReadyFrames();
  void CollectReadyFrames();
  void TellDelay(const JoinedFrame& joined);
  bool SegmentNext();
  void Remember(const rgbd_frame_t& frame, segmented_frame_t message);
  void ForgetAnswers();
  Result<segmented_frame_t> Segment(const JoinedFrame& joined);
  double Patience() const;
  void UpdateStatus();
  void LeaveOut(const std::string& reason);
  void CheckSource(const FrameHeader& header, const rgbd_frame_t& message);
  void TellCamera(const FrameHeader& header, const std::string& source);
  bool CountLosses(const DepthLosses& losses);
  void CheckSegments(const SegmentedFrame& frame);

  DepthSegmenterOptions options_;
  SegmentationStageOptions stage_;
  Bus& bus_;
  Status& status_;
  Peers peers_;
  FrameDetectionJoin join_;
  /// A published result.
  struct Answer {
    FrameKey key;
    std::string digest;         ///< of the RGBD_FRAME, see DigestOf
    segmented_frame_t message;  ///< has the rectified frame, without left-out pixels
    size_t bytes = 0;
    double time = 0;  ///< when it was made [s]
  };
  std::deque<JoinedFrame> ready_;  // do not wait for detections any longer
  int64_t dropped_behind_ = 0;     // since newer frames were ready, too
  NewestTimes newest_times_;
  Rectifier rectifier_;
  std::deque<Answer> answers_;  // the newest ones, within the limits of ForgetAnswers
  size_t answer_bytes_ = 0;
  std::set<CameraId> cameras_;  // whose intrinsics were logged
  CameraSources sources_;
  std::set<CameraId> shared_cameras_;  // that several processes publish, as STATUS has told
  ReasonCounts left_out_;              // frames that cannot be used
  ReasonCounts without_color_;         // frames whose colour cannot be decoded
  DepthLosses depth_losses_;           // of all frames
  DepthCheck segment_check_;           // of the latest frames, see CheckSegments
};

}  // namespace vismap
