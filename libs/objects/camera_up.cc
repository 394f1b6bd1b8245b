#include "objects/camera_up.h"

#include <cmath>

namespace vismap {

Eigen::Vector3d UpOfCameras(const std::vector<CameraPose>& trajectory) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CameraPose& pose : trajectory)
    sum -= pose.T_W_C.linear().col(1);  // the camera's y axis points down
  if (sum.norm() < 1e-6) return Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d mean = sum.normalized();
  Eigen::Index axis = 0;
  const double largest = mean.cwiseAbs().maxCoeff(&axis);
  if (largest < std::cos(35.0 * M_PI / 180.0)) return mean;
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  up[axis] = mean[axis] > 0 ? 1 : -1;
  return up;
}

}  // namespace vismap
