#pragma once

#include <Eigen/Core>
#include <vector>

#include "map/map_metadata.h"

namespace vismap {

/// Which way is up in W, from how the cameras were held: the axis of W nearest to the mean of their
/// upward directions when one is within 35 degrees, else that mean. Unit length; +z when there are
/// no poses.
Eigen::Vector3d UpOfCameras(const std::vector<CameraPose>& trajectory);

}  // namespace vismap
