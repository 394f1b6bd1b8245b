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

/// Which frames of a sequence to take.
struct DatasetOptions {
  int stride = 1;         ///< every stride-th recorded frame, from the first; >= 1
  int max_frames = 0;     ///< at most so many usable frames; 0 = all
  CameraId camera_id{0};  ///< given to every frame
};

/// Fails naming the option that is out of range.
Result<void> CheckOptions(const DatasetOptions& options);

/// A recorded frame that cannot be used, and why (for example: tracking was lost, no pose).
struct SkippedFrame {
  int64_t frame_number = -1;
  std::string reason;
};

/// A posed RGB-D sequence on disk (or computed): frames in the order they were taken.
class Dataset {
 public:
  virtual ~Dataset() = default;

  /// Short name for people and files, usually the folder's.
  virtual std::string name() const = 0;
  /// "scenenn", "7scenes", "tum", "icl", "scannet", "replica", "redwood", "synthetic" or "lcmlog".
  virtual std::string format() const = 0;
  /// Usable frames.
  virtual size_t size() const = 0;
  /// Header of frame i in [0, size()), without reading its images.
  virtual FrameHeader Header(size_t i) const = 0;
  /// Frame i in [0, size()). Colour files that are JPEG come through byte for byte, others are
  /// encoded once. Fails, naming the file, when one is missing, truncated, of the wrong bit depth
  /// or size. May be called from several threads at once.
  virtual Result<SensorFrame> Read(size_t i) const = 0;
  /// Recorded frames that were left out because they cannot be used.
  virtual const std::vector<SkippedFrame>& skipped() const = 0;
  /// The detections that belong to the sequence (detections.json inside it), as OpenDetections
  /// takes them; none when there are none.
  virtual std::optional<std::string> default_detections_path() const = 0;
};

/// Opens the sequence in folder `path`. `format` = one of the names above, or "" to find it by
/// looking at the folder. Fails with what is missing or malformed; unusable poses (infinite, NaN,
/// not rigid) only leave out their frame, see skipped().
Result<std::unique_ptr<Dataset>> OpenDataset(const std::string& path, const std::string& format,
                                             const DatasetOptions& options = {});

/// The formats that OpenDataset knows, for help texts.
std::vector<std::string> DatasetFormats();

}  // namespace vismap
