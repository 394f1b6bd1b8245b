#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "detection/dnn_detector.h"
#include "detector/newest_frames.h"
#include "detector/pace.h"
#include "runtime/main.h"

namespace vismap {

struct LiveDetectorOptions {
  std::optional<CameraId> camera;  ///< answer this camera only; none = all
  bool every_frame = false;        ///< look at every frame instead of the newest only
  size_t max_cached = 32;          ///< answers kept for frames that are sent again
};

/// Answers every RGBD_FRAME with one DETECTIONS by a network. Unless every_frame, the network works
/// beside the bus: frames that arrive meanwhile wait, of each camera the newest only, and a frame
/// that a newer one replaces is answered at once with "not looked at". With every_frame the process
/// takes the next frame when it is done with one, and the bus keeps what waits. A frame that cannot
/// be looked at (no colour, a broken JPEG) is answered "not looked at", too, so that nobody waits
/// for it.
class LiveDetector {
 public:
  /// Subscribes. Detector and context must outlive it.
  LiveDetector(const LiveDetectorOptions& options, DnnDetector* detector, ProcessContext* context);

  /// Works until stop is requested; then finishes the frame it is looking at.
  void Run();

 private:
  using DetectionResult = Result<DetectionSet>;
  /// A frame that the network is looking at.
  struct Work {
    rgbd_frame_t frame;
    FrameHeader header;
    double start;
    std::future<DetectionResult> result;
  };
  /// What was answered, and to which image.
  struct Answer {
    FrameKey key;
    uint64_t color;
    detections_t message;
  };

  Result<void> OnFrame(const rgbd_frame_t& message);
  void Enqueue(const rgbd_frame_t& message);
  void StartDetection(const rgbd_frame_t& message);
  void PublishIfReady(double patience);
  void PublishResult(const rgbd_frame_t& frame, const FrameHeader& header,
                     const DetectionResult& seen);
  bool RepeatAnswer(const rgbd_frame_t& message);
  void LogPace();

  LiveDetectorOptions options_;
  DnnDetector& detector_;
  Bus& bus_;
  Status& status_;
  NewestFrames waiting_;
  std::optional<Work> work_;
  std::deque<Answer> answers_;  // the newest few
  Pace pace_;
};

}  // namespace vismap
