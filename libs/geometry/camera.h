#pragma once

#include <Eigen/Core>
#include <cstddef>
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

/// The largest images: 16384 pixels along a side, and 4096 x 4096 in all.
inline constexpr int kMaxImageSide = 16384;
inline constexpr size_t kMaxImagePixels = size_t{1} << 24;
/// No pixel of a camera may see farther from its optical axis than this along one image axis.
/// Beyond, the work for a frame would grow without bound, and the intrinsics are those of another
/// image size or in another unit.
inline constexpr double kMaxViewAngleDeg = 75;
/// The largest focal length, in larger sides of the image: an angle of view of 0.06 degrees.
inline constexpr double kMaxFocalSides = 1000;

/// Fails, naming the field, unless the image size is within the limits above, and focal lengths and
/// principal point are those of a camera that sees at most kMaxViewAngleDeg to each side.
Result<PinholeCamera> ValidateCamera(const PinholeCamera& camera);

}  // namespace vismap
