#pragma once

#include <span>
#include <vector>

#include "geometry/pose.h"

namespace vismap {

/// The errors of odometry, which grow along the way. They are the same in each run.
struct PoseDrift {
  double length = 0;             ///< each motion is given as longer by this share of it; >= 0
  double degrees_per_meter = 0;  ///< the view turns too far about z of W [deg/m]; >= 0
};

/// What odometry says of these poses of a camera, which are in the order of time: it begins at the
/// first one and adds up the motions between them, each with its errors. Returns the same poses if
/// there is no drift.
std::vector<Pose> AddPoseDrift(std::span<const Pose> T_W_C, const PoseDrift& drift);

}  // namespace vismap
