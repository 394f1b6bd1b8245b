#pragma once

#include <Eigen/Core>
#include <optional>

#include "base/result.h"
#include "geometry/optics.h"

namespace vismap {

// A ray is written as (x/z, y/z) of its points in the frame of the camera. The formulas are in
// libs/METHOD.md, Rectification.

/// The pixel at which a lens shows the ray. It is meaningful up to MaxRayRadius only.
Eigen::Vector2d Distort(const LensCamera& lens, const Eigen::Vector2d& ray);

/// The ray that a lens shows at the pixel, by Newton's method; nullopt when there is none, or when
/// it is farther than 80 degrees from the optical axis.
std::optional<Eigen::Vector2d> Undistort(const LensCamera& lens, const Eigen::Vector2d& pixel);

/// Up to this length of (x/z, y/z), the distance of a pixel from the principal point grows with the
/// distance of its ray from the optical axis; at most tan(80 degrees).
double MaxRayRadius(const LensCamera& lens);

/// Whether the lens shows a pinhole image.
bool IsPinhole(const LensCamera& lens);

/// Fails unless the intrinsics are plausible (see ValidateCamera), the number of coefficients is
/// that of the model, and all are finite. Fast enough for every frame.
Result<void> CheckLens(const LensCamera& lens);

/// Fails unless the distortion gives every pixel of the image a ray of its own, so that the image
/// does not fold over. (Of a fisheye, pixels may see beyond 80 degrees.) For a lens that has passed
/// CheckLens; takes a millisecond.
Result<void> CheckOneToOne(const LensCamera& lens);

}  // namespace vismap
