#include "objects/camera_up.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace vismap {
namespace {

// Covariance of the positions, and the means of the axes.
void AddMeans(const std::vector<CameraPose>& trajectory, CameraUp* up) {
  const auto count = static_cast<double>(trajectory.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const CameraPose& pose : trajectory) {
    up->right_W += pose.T_W_C.linear().col(0) / count;
    up->view_W += pose.T_W_C.linear().col(2) / count;
    mean += pose.T_W_C.translation() / count;
  }
  for (const CameraPose& pose : trajectory) {
    const Eigen::Vector3d d = pose.T_W_C.translation() - mean;
    up->motion_W += d * d.transpose() / count;
  }
}

}  // namespace

std::string DirectionText(const Eigen::Vector3d& direction) {
  std::array<char, 128> text{};
  const auto rounded = [](double value) { return std::round(value * 1e3) / 1e3 + 0.0; };
  std::snprintf(text.data(), text.size(), "(%g, %g, %g)", rounded(direction.x()),
                rounded(direction.y()), rounded(direction.z()));
  return text.data();
}

CameraUp UpOfCameras(const std::vector<CameraPose>& trajectory) {
  CameraUp up;
  up.reason = "z is taken, since the cameras do not tell";
  if (trajectory.empty()) return up;
  AddMeans(trajectory, &up);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CameraPose& pose : trajectory)
    sum -= pose.T_W_C.linear().col(1);  // the camera's y axis points down
  if (sum.norm() < 1e-6) return up;
  up.up_W = sum.normalized();
  up.reason = "the mean of the cameras' upward directions";
  Eigen::Index axis = 0;
  const double largest = up.up_W.cwiseAbs().maxCoeff(&axis);
  if (largest < std::cos(35 * std::numbers::pi / 180)) return up;
  const double sign = up.up_W[axis] > 0 ? 1 : -1;
  up.up_W = Eigen::Vector3d::Zero();
  up.up_W[axis] = sign;
  up.reason = "the axis of the world that is nearest to the cameras' upward directions";
  return up;
}

}  // namespace vismap
