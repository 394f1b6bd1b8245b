#pragma once

#include <cstdint>

#include "geometry/pose.h"

namespace vismap {

/// Errors of the poses, independent for each frame.
struct PoseNoise {
  double deviation = 0;  ///< standard deviation of the position along each axis [m]; >= 0
  /// Standard deviation of the rotation about each axis of the camera, divided by `deviation`
  /// [deg/cm].
  double degrees_per_cm = 0.25;
};

/// The pose with errors, which are a function of `key`. Returns the same pose if `deviation` is 0.
Pose AddPoseNoise(const Pose& T_W_C, const PoseNoise& noise, uint64_t key);

}  // namespace vismap
