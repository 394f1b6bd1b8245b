#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// Which frames of a sequence are used.
struct DatasetOptions {
  int stride = 1;         ///< use every stride-th recorded frame, from the first; >= 1
  int max_frames = 0;     ///< use at most so many usable frames; 0 = all
  CameraId camera_id{0};  ///< id of the camera in all headers
};

/// Fails if an option is out of range, and names it.
Result<void> CheckOptions(const DatasetOptions& options);

/// A recorded frame that cannot be used, and the reason, such as a missing pose.
struct SkippedFrame {
  int64_t frame_number = -1;
  std::string reason;
};

/// An RGB-D sequence with poses, recorded or computed. Frames are in the order of their times.
class Dataset {
 public:
  virtual ~Dataset() = default;

  /// A short name for display and files, usually that of the folder.
  virtual std::string name() const = 0;
  /// "scenenn", "7scenes", "tum", "icl", "scannet", "replica", "redwood", "synthetic" or "lcmlog".
  virtual std::string format() const = 0;
  /// Number of usable frames.
  virtual size_t size() const = 0;
  /// The header of frame i in [0, size()). Does not read its images.
  virtual FrameHeader Header(size_t i) const = 0;
  /// Reads frame i in [0, size()). The bytes of JPEG files are passed on unchanged; other colour
  /// files are encoded as JPEG. Fails, naming the file, if it is missing, truncated, or of the
  /// wrong bit depth or size. Several threads may call it at once.
  virtual Result<SensorFrame> Read(size_t i) const = 0;
  /// The recorded frames that were left out because they cannot be used.
  virtual const std::vector<SkippedFrame>& skipped() const = 0;
  /// The path of the detections that belong to the sequence, for OpenDetections; none if there are
  /// no detections. In a folder, it is the file detections.json.
  virtual std::optional<std::string> default_detections_path() const = 0;
};

/// Opens the sequence in the folder `path`. `format` is one of the names above, or "" to recognise
/// it by the files of the folder. Fails, naming the file, if it is missing or malformed. A pose
/// that cannot be used (infinite, NaN, not rigid) is not an error: its frame is left out, see
/// skipped().
Result<std::unique_ptr<Dataset>> OpenDataset(const std::string& path, const std::string& format,
                                             const DatasetOptions& options = {});

}  // namespace vismap
