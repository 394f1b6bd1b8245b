#pragma once

#include <Eigen/Geometry>

#include "base/result.h"

namespace vismap {

/// Rigid transform; `T_A_B` maps coordinates in B to A: p_A = T_A_B * p_B.
using Pose = Eigen::Isometry3d;

/// Checks that a 4x4 matrix is a finite rigid transform (rotation orthonormal with determinant +1
/// within 1e-3, last row 0 0 0 1, translation below 1e5 m) and returns it. A rotation that is
/// off by more than 1e-9 is made orthonormal, so that a second call changes nothing. Fails with the
/// reason otherwise.
Result<Pose> MakePose(const Eigen::Matrix4d& matrix);

}  // namespace vismap
