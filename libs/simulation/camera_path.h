#pragma once

#include <vector>

#include "geometry/pose.h"

namespace vismap {

/// T_W_C of a camera at `eye_W` that looks at `target_W` [m], with z of W up in the image. Throws
/// if the two are above each other.
Pose LookAt(const Eigen::Vector3d& eye_W, const Eigen::Vector3d& target_W);

/// The point at parameter `s`, in [0, points.size()), of the closed Catmull-Rom curve through the
/// points. Point i is at s = i.
Eigen::Vector3d CurveAt(const std::vector<Eigen::Vector3d>& points, double s);

}  // namespace vismap
