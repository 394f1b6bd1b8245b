#include "mcap/frame_topics.h"

#include <algorithm>

#include "mcap/foxglove_fields.h"
#include "mcap/map_topics.h"

namespace vismap {
namespace {

constexpr size_t kRememberedFrames = 4096, kMostCameras = 256;
constexpr size_t kMostPoses = 500;        // of a path
constexpr int64_t kPathPeriod = 1000000;  // [us]

std::string CameraName(CameraId camera) { return "camera" + std::to_string(Raw(camera)); }

std::string CameraTopic(CameraId camera) { return "/" + CameraName(camera); }

bool HasDepthCamera(const SensorFrame& frame) {
  return frame.optics && !frame.optics->depth_registered && !frame.color.empty();
}

LensCamera ColorLens(const SensorFrame& frame) {
  return frame.optics ? frame.optics->color : LensCamera{frame.header.camera};
}

LensCamera DepthLens(const SensorFrame& frame) {
  if (!frame.optics) return {frame.header.camera};
  const bool as_color = frame.optics->depth_registered && !frame.color.empty();
  return as_color ? frame.optics->color : frame.optics->depth;
}

}  // namespace

bool FrameTopics::HasTopics(CameraId camera) {
  if (cameras_.size() < kMostCameras) cameras_.insert(camera);
  if (cameras_.contains(camera)) return true;
  ++left_out_;
  return false;
}

std::string FrameTopics::Remark() const {
  if (left_out_ == 0) return "";
  return std::to_string(left_out_) + " messages of cameras were left out: only the first " +
         std::to_string(kMostCameras) + " cameras are written";
}

bool FrameTopics::WriteFrame(const SensorFrame& frame, int64_t log_us) {
  const FrameHeader& header = frame.header;
  const FrameKey key{header.camera_id, header.utime};
  if (Contains(key)) return false;
  Remember(key);
  if (!HasTopics(header.camera_id)) return true;
  const MessageTimes times{log_us, header.utime};
  const std::string name = CameraName(header.camera_id), topic = CameraTopic(header.camera_id);
  file_.Write("/tf", times, TransformMessage(kWorldFrame, name, header.T_W_C, header.utime));
  WriteImages(frame, topic, name, times);
  file_.Write(topic + "/pose", times, PoseMessage(header.T_W_C, header.utime));
  ExtendPath(frame, times);
  return true;
}

void FrameTopics::WriteImages(const SensorFrame& frame, const std::string& topic,
                              const std::string& frame_id, const MessageTimes& times) {
  const int64_t utime = frame.header.utime;
  const std::string depth_frame = HasDepthCamera(frame) ? frame_id + "_depth" : frame_id;
  if (HasDepthCamera(frame))
    file_.Write("/tf", times,
                TransformMessage(frame_id, depth_frame, frame.optics->T_color_depth, utime));
  if (!frame.color.empty()) {
    file_.Write(topic + "/color/calibration", times,
                CalibrationMessage(ColorLens(frame), utime, frame_id));
    file_.Write(topic + "/color/image", times, ColorMessage(frame, frame_id));
  }
  file_.Write(topic + "/depth/calibration", times,
              CalibrationMessage(DepthLens(frame), utime, depth_frame));
  file_.Write(topic + "/depth/image", times, DepthMessage(frame, depth_frame));
}

void FrameTopics::WriteDetections(const DetectionSet& set, int64_t log_us) {
  if (!HasTopics(set.camera_id)) return;
  file_.Write(CameraTopic(set.camera_id) + "/detections", {log_us, set.utime},
              DetectionsMessage(set, ClassName));
}

void FrameTopics::WriteSegments(const FrameKey& frame, const PinholeCamera& camera,
                                const SegmentImage& image, int64_t log_us) {
  if (!HasTopics(frame.camera_id)) return;
  const MessageTimes times{log_us, frame.utime};
  const std::string name = CameraName(frame.camera_id), topic = CameraTopic(frame.camera_id);
  file_.Write(topic + "/segments/calibration", times,
              CalibrationMessage({camera}, frame.utime, name));
  file_.Write(topic + "/segments/image", times, SegmentsMessage(image, frame.utime, name));
}

void FrameTopics::Remember(const FrameKey& frame) {
  written_.insert(frame);
  written_order_.push_back(frame);
  if (written_order_.size() <= kRememberedFrames) return;
  written_.erase(written_order_.front());
  written_order_.pop_front();
}

void FrameTopics::ExtendPath(const SensorFrame& frame, const MessageTimes& times) {
  Path& path = paths_[frame.header.camera_id];
  if (path.frames == 0) path.begun_us = path.written_us = times.log_us;
  path.newest = times;
  if (path.frames++ % path.stride != 0) return;
  path.T_W_C.push_back(frame.header.T_W_C);
  path.changed = true;
  if (path.T_W_C.size() > kMostPoses) {
    for (size_t i = 0; 2 * i < path.T_W_C.size(); ++i) path.T_W_C[i] = path.T_W_C[2 * i];
    path.T_W_C.resize((path.T_W_C.size() + 1) / 2);
    path.stride *= 2;
  }
  // Longer paths are written more seldom, so that the paths of a long log take little room.
  const int64_t period =
      std::max(kPathPeriod, std::max(times.log_us, path.begun_us) / 50 - path.begun_us / 50);
  if (path.frames == 1 || Passed(path.written_us, times.log_us, period))
    WritePath(frame.header.camera_id, &path);
}

void FrameTopics::WritePath(CameraId camera, Path* path) {
  file_.Write(CameraTopic(camera) + "/path", path->newest,
              PathMessage(path->T_W_C, path->newest.publish_us));
  path->written_us = path->newest.log_us;
  path->changed = false;
}

void FrameTopics::Finish() {
  for (auto& [camera, path] : paths_)
    if (path.changed) WritePath(camera, &path);
}

}  // namespace vismap
