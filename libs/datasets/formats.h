#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/result.h"
#include "datasets/register_depth.h"
#include "datasets/text_file.h"
#include "geometry/camera.h"
#include "geometry/pose.h"

namespace vismap {

/// One recorded frame: where its files are and what is known of it before they are read.
struct FrameFiles {
  int64_t number = 0;  ///< as detection files count
  int64_t utime = 0;   ///< [us]
  std::filesystem::path color;
  std::filesystem::path depth;
  Result<Pose> T_W_C = Pose::Identity();  ///< or why the frame is unusable
};

/// What a folder holds, whatever its format.
struct SequenceFiles {
  /// Of the depth images; with `depth_from`, of the colour images, where depth is carried over to.
  PinholeCamera camera;
  std::optional<DepthSource> depth_from;      ///< when depth was not recorded as colour sees it
  std::optional<PinholeCamera> color_camera;  ///< when colour is of another size than depth
  double depth_unit_m = 0.001;
  std::vector<FrameFiles> frames;  ///< as recorded, unusable ones included
};

/// One folder layout: how to recognise it and how to list it. See each .cc for the layout.
struct DatasetFormat {
  const char* name;
  const char* looks_like;  ///< what it is recognised by, for error messages
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

/// Time of frame `number` of a camera with `rate` frames a second [us].
int64_t UtimeAtRate(int64_t number, double rate);

/// Size of the first depth image, for formats that do not state it.
Result<PinholeCamera> WithSizeOfFirstDepth(PinholeCamera camera,
                                           const std::vector<FrameFiles>& frames);

/// A trajectory.log (SceneNN, Redwood): blocks of a line "i i i+1" and a 4x4 camera-to-world
/// matrix. Poses in order of the file with their index; a pose that is not rigid is an Error in its
/// place.
struct LoggedPose {
  int64_t index = 0;
  Result<Pose> T_W_C = Pose::Identity();
};
Result<std::vector<LoggedPose>> ReadTrajectoryLog(const std::filesystem::path& path);

/// Colour and depth files paired by number; fails naming the missing file when one has no partner,
/// or the folder when there are none. Only number, color, depth are filled.
Result<std::vector<FrameFiles>> PairByNumber(const NamePattern& color, const NamePattern& depth);

/// ReadNumbers of 16 numbers as a pose. The outer error: the file is missing or malformed; the
/// inner: the pose is not usable.
Result<Result<Pose>> ReadPoseFile(const std::filesystem::path& path);

}  // namespace vismap
