#pragma once

#include <Eigen/Core>
#include <vector>

#include "map/map_metadata.h"

namespace vismap {

/// The upward direction of W, estimated from the camera poses: the axis of W that is nearest to the
/// mean of the cameras' upward directions (-y of C), if it is within 35 degrees of that mean, else
/// the mean itself. Unit length. +z when there are no poses or the directions cancel each other.
Eigen::Vector3d UpOfCameras(const std::vector<CameraPose>& trajectory);

}  // namespace vismap
