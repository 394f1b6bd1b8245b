#pragma once

#include <cstdint>
#include <vector>
#include <vismap/pose_correction_t.hpp>

#include "base/ids.h"
#include "base/result.h"
#include "geometry/pose_correction.h"

namespace vismap {

/// Most poses in one correction.
inline constexpr int32_t kMaxCorrectedPoses = 200000;

/// New poses for frames of a camera that are in the map already.
struct PoseCorrection {
  CameraId camera_id{0};
  bool interpolated = false;      ///< frames that are not named get the interpolated correction
  std::vector<PoseAtTime> poses;  ///< by time; each time once
};

/// `message.utime` and `message.request_id` are left at 0.
pose_correction_t Encode(const PoseCorrection& correction);

/// Fails, naming the field, on a camera below 0, an unknown mode, no or too many poses, a time that
/// occurs twice, and a pose that is no rigid transform, see MakePose.
Result<PoseCorrection> Decode(const pose_correction_t& message);

}  // namespace vismap
