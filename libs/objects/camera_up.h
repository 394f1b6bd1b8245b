#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "map/map_metadata.h"

namespace vismap {

/// What the poses of the cameras say about the upward direction of W.
struct CameraUp {
  /// The axis of W that is nearest to the mean of the cameras' upward directions (-y of C), if it
  /// is within 35 degrees of that mean, else the mean itself. Unit length. +z when there are no
  /// poses or the directions cancel each other.
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();
  std::string reason;  ///< how up_W was found, as a phrase
  Eigen::Vector3d right_W =
      Eigen::Vector3d::Zero();  ///< mean of the cameras' x axes, at most 1 long
  Eigen::Vector3d view_W = Eigen::Vector3d::Zero();  ///< mean of their optical axes, at most 1 long
  /// Covariance of the cameras' positions [m^2].
  Eigen::Matrix3d motion_W = Eigen::Matrix3d::Zero();
};

CameraUp UpOfCameras(const std::vector<CameraPose>& trajectory);

/// "(0, 0, 1)".
std::string DirectionText(const Eigen::Vector3d& direction);

}  // namespace vismap
