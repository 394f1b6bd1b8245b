#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "logs/map_history.h"
#include "logs/recorded_run.h"

namespace vismap {

/// The frames of a log that form a sequence, in the order of the sequence.
struct FrameSelection {
  std::vector<RecordedFrame> frames;
  std::vector<SkippedFrame> skipped;
  std::vector<std::string> remarks;  ///< sentences, see MapHistory
};

/// Selects the frames of the newest map, in the order of their commits; with `all`, or when the log
/// has no commits, all frames in order of arrival. Of these, it keeps every options.stride-th and
/// at most options.max_frames.
FrameSelection SelectFrames(const RecordedRun& run, bool all, const DatasetOptions& options);

/// The frames of a log as a sequence. A frame is read from the file when it is requested.
class LogDataset : public Dataset {
 public:
  /// `detections_path` is the path of the log for OpenRecordedDetections; nullopt = the log has no
  /// detections. Intrinsics and depth unit of the options replace those of all frames.
  LogDataset(LogReader reader, FrameSelection selection, std::optional<std::string> detections_path,
             const DatasetOptions& options);

  std::string name() const override;
  std::string format() const override { return "lcmlog"; }
  size_t size() const override { return selection_.frames.size(); }
  FrameHeader Header(size_t i) const override;
  Result<SensorFrame> Read(size_t i) const override;
  const std::vector<SkippedFrame>& skipped() const override { return selection_.skipped; }
  std::vector<std::string> remarks() const override;
  std::optional<std::string> default_detections_path() const override { return detections_path_; }

 private:
  LogReader reader_;
  FrameSelection selection_;
  std::optional<std::string> detections_path_;
  DatasetOptions options_;
};

/// The detections in a log, found by camera and utime.
class LogDetections : public DetectionSource {
 public:
  /// Frames that the recorded run integrated without detections get none, unless `all` is set.
  LogDetections(LogReader reader, const RecordedRun& run, bool all);

  Result<DetectionSet> ForFrame(const FrameHeader& header) const override;
  bool DetectorRan(const FrameHeader& header) const override;
  int64_t size() const override { return -1; }

 private:
  LogReader reader_;
  std::map<FrameKey, LogEvent> messages_;
};

}  // namespace vismap
