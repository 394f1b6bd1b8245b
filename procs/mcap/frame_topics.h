#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "mcap/camera_messages.h"
#include "wire/frame_key.h"

namespace vismap {

/// Writes the frames of each camera N to the topics /cameraN/...: colour, depth, their
/// calibrations, pose, the path so far, detections and segments; and to /tf the poses of its frames
/// of reference: "cameraN", and "cameraN_depth" when depth has a camera of its own.
class FrameTopics {
 public:
  explicit FrameTopics(FoxgloveFile* file) : file_(*file) {}

  /// Returns false, and writes nothing, when a frame of this camera and utime was written before;
  /// the newest 4096 of them are known. `log_us`: see MessageTimes.
  bool WriteFrame(const SensorFrame& frame, int64_t log_us);
  /// Whether WriteFrame would return false.
  bool Contains(const FrameKey& frame) const { return written_.contains(frame); }
  void WriteDetections(const DetectionSet& set, int64_t log_us);
  /// `camera` = of the segment image.
  void WriteSegments(const FrameKey& frame, const PinholeCamera& camera, const SegmentImage& image,
                     int64_t log_us);
  /// What was left out, a sentence; "" = nothing.
  std::string Remark() const;
  /// Writes the whole path of each camera once more, with its last poses.
  void Finish();

 private:
  /// Every stride-th pose of a camera; the stride doubles when there are too many.
  struct Path {
    std::vector<Pose> T_W_C;
    int64_t frames = 0, stride = 1;
    bool changed = false;
    int64_t begun_us = 0, written_us = 0;  // times of the log
    MessageTimes newest;
  };
  bool HasTopics(CameraId camera);
  void Remember(const FrameKey& frame);
  void WriteImages(const SensorFrame& frame, const std::string& topic, const std::string& frame_id,
                   const MessageTimes& times);
  void ExtendPath(const SensorFrame& frame, const MessageTimes& times);
  void WritePath(CameraId camera, Path* path);

  FoxgloveFile& file_;
  std::set<FrameKey> written_;
  std::deque<FrameKey> written_order_;
  std::map<CameraId, Path> paths_;
  std::set<CameraId> cameras_;  // that have topics
  int64_t left_out_ = 0;
};

}  // namespace vismap
