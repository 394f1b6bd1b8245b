#include "simulation/camera_path.h"

#include "base/require.h"

namespace vismap {

using Eigen::Vector3d;

Pose LookAt(const Vector3d& eye_W, const Vector3d& target_W) {
  const Vector3d forward = (target_W - eye_W).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitZ());
  Require(right.norm() > 1e-6, "a camera with a level horizon does not look straight up or down");
  Pose T_W_C = Pose::Identity();
  T_W_C.linear().col(0) = right.normalized();
  T_W_C.linear().col(1) = forward.cross(T_W_C.linear().col(0));
  T_W_C.linear().col(2) = forward;
  T_W_C.translation() = eye_W;
  return T_W_C;
}

Vector3d CurveAt(const std::vector<Vector3d>& points, double s) {
  const size_t n = points.size();
  const auto k = static_cast<size_t>(s);
  const double x = s - static_cast<double>(k);
  const Vector3d& a = points[(k + n - 1) % n];
  const Vector3d& b = points[k % n];
  const Vector3d& c = points[(k + 1) % n];
  const Vector3d& d = points[(k + 2) % n];
  return b + 0.5 * x * ((c - a) + x * ((2 * a - 5 * b + 4 * c - d) + x * (3 * (b - c) + d - a)));
}

}  // namespace vismap
