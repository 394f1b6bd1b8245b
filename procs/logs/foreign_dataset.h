#pragma once

#include <memory>
#include <string>
#include <vector>
#include <vismap/rgbd_frame_t.hpp>

#include "config/process_options.h"
#include "datasets/dataset.h"
#include "foreign/camera_joiners.h"
#include "logs/log_reader.h"

namespace vismap {

/// The frames of a log of other robots' programs as a sequence: the same ones that a running
/// adapter makes of these messages. The log is read once to join them, and an image again when it
/// is requested; no more than adapter.queue_mb of it is in memory.
class ForeignDataset : public Dataset {
 public:
  /// `adapter` may lack presets: they are found from the channels of the log. Fails when none fits,
  /// when a key is missing (it names the key), and when no frame can be used (it says why).
  static Result<std::unique_ptr<ForeignDataset>> Open(const std::string& path,
                                                      const AdapterOptions& adapter,
                                                      const DatasetOptions& options);

  std::string name() const override;
  std::string format() const override { return "lcmlog"; }
  size_t size() const override { return frames_.size(); }
  FrameHeader Header(size_t i) const override;
  Result<SensorFrame> Read(size_t i) const override;
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::vector<std::string> remarks() const override { return remarks_; }
  double depth_unit_m() const override { return cameras_.front().depth_unit_m; }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }

  /// Frame i as a running adapter publishes it.
  Result<rgbd_frame_t> Message(size_t i) const;

 private:
  struct Frame {
    size_t camera = 0;    // place in cameras_
    ForeignFrame joined;  // without pixels
    FrameHeader header;
  };

  ForeignDataset(LogReader reader, const std::vector<AdapterCameraOptions>& cameras)
      : reader_(std::move(reader)), cameras_(cameras) {}
  Result<void> Scan(const DatasetOptions& options);
  void Keep(size_t camera, ForeignFrame joined, const DatasetOptions& options);
  void AddRemarks(const CameraJoiners& joiners, int64_t damaged);
  Result<ForeignMessage> MessageAt(int64_t number, ImageRole role, bool is_color,
                                   const AdapterCameraOptions& camera) const;
  Result<void> ReadPixels(const AdapterCameraOptions& camera, bool is_color,
                          ForeignImage* image) const;

  LogReader reader_;
  std::vector<AdapterCameraOptions> cameras_;
  std::vector<LogEvent> images_;  // events that have images of frames; their index is the number
  std::vector<Frame> frames_;
  int64_t found_ = 0;
  std::vector<SkippedFrame> skipped_;
  std::vector<std::string> remarks_;
};

/// Whether the log has channels that a preset or `adapter` names.
Result<bool> HasForeignImages(const std::string& path, const AdapterOptions& adapter);

}  // namespace vismap
