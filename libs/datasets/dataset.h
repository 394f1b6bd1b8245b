#pragma once

#include <array>
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

/// Whether depth was recorded as the colour camera sees it.
enum class DepthRegistration {
  kAuto,        ///< as the sequence states; registered when it states nothing
  kRegistered,  ///< it was
  kKinect,      ///< as a Kinect's infrared camera sees it; it is registered when it is read
};

/// Which frames of a sequence are used, and calibration that replaces what the sequence states.
struct DatasetOptions {
  int stride = 1;         ///< use every stride-th recorded frame, from the first; >= 1
  int max_frames = 0;     ///< use at most so many usable frames; 0 = all
  CameraId camera_id{0};  ///< id of the camera in all headers
  /// fx, fy, cx, cy of the depth images [px]; nullopt = those that the sequence states.
  std::optional<std::array<double, 4>> intrinsics = std::nullopt;
  double depth_unit_m = 0;  ///< metres per step of the depth images; 0 = as the sequence states
  DepthRegistration registration = DepthRegistration::kAuto;
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
  /// How the sequence is read, one sentence each, for the log: where the intrinsics and the depth
  /// unit come from, and whether depth counts as registered to colour.
  virtual std::vector<std::string> remarks() const { return {}; }
  /// Metres per step of the depth images; 0 = unknown.
  virtual double depth_unit_m() const { return 0; }
  /// Whether the sequence states when its frames were taken. If not, their times are computed from
  /// their numbers, and those of another sequence may be the same.
  virtual bool has_clock() const { return true; }
  /// The path of the detections that belong to the sequence, for OpenDetections; none if there are
  /// no detections. In a folder, it is the file detections.json.
  virtual std::optional<std::string> default_detections_path() const = 0;
};

/// Opens the sequence in the folder `path`. `format` is one of the names above, or "" to recognise
/// it by the files of the folder. Fails, naming the file, if it is missing or malformed. A pose
/// that cannot be used (infinite, NaN, not rigid) is not an error: its frame is left out, see
/// skipped(). Fails if no frame is left, with the most frequent reason.
Result<std::unique_ptr<Dataset>> OpenDataset(const std::string& path, const std::string& format,
                                             const DatasetOptions& options = {});

}  // namespace vismap
