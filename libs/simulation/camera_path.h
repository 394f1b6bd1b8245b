#pragma once

#include <vector>

#include "geometry/pose.h"

namespace vismap {

/// Camera to world for a camera at `eye_W` that looks at `target_W` with world z up in the image.
/// The two must not be above each other.
Pose LookAt(const Eigen::Vector3d& eye_W, const Eigen::Vector3d& target_W);

/// Closed Catmull-Rom curve through the points; `s` in [0, points.size()), whole at the points.
Eigen::Vector3d CurveAt(const std::vector<Eigen::Vector3d>& points, double s);

}  // namespace vismap
