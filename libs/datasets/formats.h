#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/result.h"
#include "datasets/image_file.h"
#include "datasets/register_depth.h"
#include "datasets/text_file.h"
#include "geometry/camera.h"
#include "geometry/pose.h"

namespace vismap {

/// One recorded frame: the paths of its files, and what is known before they are read.
struct FrameFiles {
  int64_t number = 0;  ///< the frame_number, by which detection files refer to it
  int64_t utime = 0;   ///< [us]
  std::filesystem::path color;
  std::filesystem::path depth;
  Result<Pose> T_W_C = Pose::Identity();  ///< the error says why the frame cannot be used
  std::string missing;  ///< which of its images, or its time, there is not; empty = nothing
};

/// The camera of the depth images, and how it is known.
struct KnownCamera {
  PinholeCamera camera;  ///< width 0 = the size is that of the first depth image
  std::string source;    ///< the file that states it, or "assumed for a Kinect"
  /// The folder does not state the intrinsics. The values are those of a usual sensor, and hold for
  /// images of the size in `camera` only.
  bool assumed = false;
};

/// The content of a sequence's folder, in any format.
struct SequenceFiles {
  Result<KnownCamera> known_camera = Fail("the intrinsics are unknown");
  /// The camera of the frames, see ResolveCamera. It is the camera of the depth images, or, if
  /// `depth_from` is set, that of the colour images, to which depth is registered.
  PinholeCamera camera;
  std::optional<DepthSource> depth_from;         ///< set if depth is not registered to colour
  std::optional<PinholeCamera> color_camera;     ///< set if colour has another size than depth
  double depth_unit_m = 0.001;                   ///< metres per step of the depth images
  std::string depth_unit_source = "the format";  ///< or the file that states it
  /// The depth may be that of a Kinect's infrared camera, not registered to colour. It is if pixels
  /// without a return are 65535, or if the folders are named as those of the original 7-Scenes.
  bool may_be_kinect_depth = false;
  bool named_as_seven_scenes = false;
  std::vector<FrameFiles> frames;  ///< as recorded, also those that cannot be used
  bool has_clock = false;          ///< the folder states the times of the frames
};

/// A layout of a sequence's folder: functions that recognise it and list its files. Each .cc file
/// describes its layout.
struct DatasetFormat {
  const char* name;
  const char* looks_like;  ///< the files by which it is recognised, for error messages
  bool (*recognise)(const std::filesystem::path& folder);
  Result<SequenceFiles> (*list)(const std::filesystem::path& folder);
};

extern const DatasetFormat kSceneNnFormat;
extern const DatasetFormat kSevenScenesFormat;
extern const DatasetFormat kTumFormat;
extern const DatasetFormat kIclFormat;
extern const DatasetFormat kScanNetFormat;
extern const DatasetFormat kReplicaFormat;
extern const DatasetFormat kRedwoodFormat;

/// Frames per second of the formats whose files hold no times.
inline constexpr double kUsualRate = 30;

/// The header of the first image whose header can be read, of frames with both images: of their
/// `image`, `&FrameFiles::depth` or `&FrameFiles::color`. Fails with what is wrong with the first.
Result<ImageFileInfo> FirstInfo(const std::vector<FrameFiles>& frames,
                                std::filesystem::path FrameFiles::*image);

/// The time of frame `number` of a camera with `rate` frames per second [us].
int64_t UtimeAtRate(int64_t number, double rate);

/// Sets `files->camera` to `intrinsics` (fx, fy, cx, cy), or to the known camera if there are none,
/// with the size of the first depth image if the folder does not state the size. A left-handed
/// camera (fy below 0) is mirrored together with its poses. Fails, naming `folder`, if the camera
/// is unknown or impossible, or was assumed for images of another size. Returns the source of the
/// camera for the log.
Result<std::string> ResolveCamera(const std::filesystem::path& folder,
                                  const std::optional<std::array<double, 4>>& intrinsics,
                                  SequenceFiles* files);

/// Registers depth of a Kinect's infrared camera to its colour camera with the nominal calibration:
/// `camera` becomes that of colour, and the poses follow. Fails if the images are not 640x480.
Result<void> RegisterKinectDepth(SequenceFiles* files);

/// A pose of a trajectory.log with its index. The error says why the pose cannot be used.
struct LoggedPose {
  int64_t index = 0;
  Result<Pose> T_W_C = Pose::Identity();
};

/// Reads a trajectory.log (SceneNN, Redwood), which has blocks of a line "i i i+1" and the 4x4
/// matrix T_W_C. The poses are in the order of the file. Fails, naming the line, if the file is
/// malformed.
Result<std::vector<LoggedPose>> ReadTrajectoryLog(const std::filesystem::path& path);

/// Pairs colour and depth files by number. Sets only number, color, depth and missing of the
/// frames. Fails, naming the folder, if it has no images, or, naming the file, if its number is too
/// large for that of a frame.
Result<std::vector<FrameFiles>> PairByNumber(const NamePattern& color, const NamePattern& depth);

/// Reads the 4x4 matrix T_W_C of a text file. The outer error says that the file is missing or
/// malformed, the inner one that the pose cannot be used.
Result<Result<Pose>> ReadPoseFile(const std::filesystem::path& path);

}  // namespace vismap
