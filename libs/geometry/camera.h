#pragma once

#include <Eigen/Core>
#include <string>

#include "base/result.h"

namespace vismap {

/// Pinhole camera without distortion. Intrinsics in pixels; pixel centres at integer (u, v).
/// Camera frame C: x right, y down, z forward along the optical axis.
struct PinholeCamera {
  int width = 0;
  int height = 0;
  double fx = 0, fy = 0, cx = 0, cy = 0;

  /// The point at pixel (u, v) with depth z [m] along the optical axis, in C [m].
  Eigen::Vector3d BackProject(double u, double v, double z) const {
    return {z * (u - cx) / fx, z * (v - cy) / fy, z};
  }
  /// Pixel (u, v) of a point in C [m]; z must be positive.
  Eigen::Vector2d Project(const Eigen::Vector3d& p_C) const {
    return {fx * p_C.x() / p_C.z() + cx, fy * p_C.y() / p_C.z() + cy};
  }
  friend bool operator==(const PinholeCamera&, const PinholeCamera&) = default;
};

/// "fx 525 fy 525 cx 319.5 cy 239.5 (640x480)".
std::string CameraText(const PinholeCamera& camera);

/// Fails, naming the field, unless sizes are in [1, 16384] and focal lengths and principal point
/// are finite and plausible.
Result<PinholeCamera> ValidateCamera(const PinholeCamera& camera);

}  // namespace vismap
