#pragma once

#include <filesystem>
#include <vector>

#include "base/result.h"
#include "geometry/pose_correction.h"

namespace vismap {

/// Reads a trajectory as SLAM systems write it in the format of TUM: lines "TIME tx ty tz qx qy qz
/// qw" with the time in seconds, to the microsecond, and the pose T_W_C; '#' begins a comment.
/// Fails, naming file and line, on anything else, and when there is no pose or a time occurs twice.
Result<std::vector<PoseAtTime>> ReadTumTrajectory(const std::filesystem::path& path);

}  // namespace vismap
