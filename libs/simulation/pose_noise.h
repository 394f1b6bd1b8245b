#pragma once

#include <cstdint>

#include "geometry/pose.h"

namespace vismap {

/// Errors of a pose source, drawn anew for each frame.
struct PoseNoise {
  double deviation = 0;  ///< of the position along each axis [m]; >= 0
  /// Deviation of the rotation about each axis of the camera, per `deviation` [deg/cm].
  double degrees_per_cm = 0.25;
};

/// The pose with errors; the same one for no deviation. `key` decides on the errors.
Pose AddPoseNoise(const Pose& T_W_C, const PoseNoise& noise, uint64_t key);

}  // namespace vismap
