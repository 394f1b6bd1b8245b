#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <optional>
#include <vismap/detections_t.hpp>
#include <vismap/rgbd_frame_t.hpp>

#include "config/process_options.h"
#include "detection/dnn_detector.h"
#include "detector/newest_frames.h"
#include "detector/pace.h"
#include "rectify/rectifier.h"
#include "runtime/main.h"

namespace vismap {

/// Runs a network on the frames on the bus and publishes exactly one DETECTIONS message for every
/// RGBD_FRAME. By default it runs on the newest frame: while the network works in another thread,
/// the newest frame of each camera waits, and a frame that is replaced by a newer one is skipped,
/// for which EncodeDetectorDidNotRun is published immediately. With every_frame it runs on every
/// frame, one after the other, and the hub queues the waiting ones. A frame without colour or with
/// a damaged JPEG is skipped, too, so that no process waits for its detections.
class LiveDetector {
 public:
  /// Subscribes to RGBD_FRAME. `detector` and `context` must outlive the object.
  LiveDetector(const DetectorOptions& options, DnnDetector* detector, ProcessContext* context);

  /// Runs until stop is requested, then finishes the current frame.
  void Run();

 private:
  using DetectionResult = Result<DetectionSet>;
  /// The frame on which the network is running.
  struct Work {
    rgbd_frame_t frame;
    FrameHeader header;
    double start;  // MonotonicSeconds
    std::future<DetectionResult> result;
  };
  /// A published result, and the colour image from which it was computed.
  struct Answer {
    FrameKey key;
    uint64_t color;  // checksum of its bytes
    detections_t message;
  };

  Result<void> OnFrame(const rgbd_frame_t& message);
  void Enqueue(const rgbd_frame_t& message);
  void StartDetection(const rgbd_frame_t& message);
  void PublishIfReady(double timeout);
  void PublishResult(const rgbd_frame_t& frame, const FrameHeader& header,
                     const DetectionResult& result);
  bool RepeatAnswer(const rgbd_frame_t& message);
  void LogPace();

  DetectorOptions options_;
  DnnDetector& detector_;
  Rectifier rectifier_;  // used by one detection at a time
  Bus& bus_;
  Status& status_;
  NewestFrames waiting_;
  std::optional<Work> work_;
  std::deque<Answer> answers_;  // the newest ones, at most kMaxAnswers
  Pace pace_;
};

}  // namespace vismap
