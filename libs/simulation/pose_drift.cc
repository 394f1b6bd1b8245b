#include "simulation/pose_drift.h"

#include <cmath>

#include "base/require.h"

namespace vismap {

std::vector<Pose> AddPoseDrift(std::span<const Pose> T_W_C, const PoseDrift& drift) {
  Require(drift.length >= 0 && drift.degrees_per_meter >= 0, "drift is not negative");
  std::vector<Pose> drifted(T_W_C.begin(), T_W_C.end());
  if (drift.length == 0 && drift.degrees_per_meter == 0) return drifted;
  double heading = 0;  // by which the view has turned too far [rad]
  for (size_t i = 1; i < T_W_C.size(); ++i) {
    const Eigen::Vector3d way_W = T_W_C[i].translation() - T_W_C[i - 1].translation();
    const Eigen::AngleAxisd before(heading, Eigen::Vector3d::UnitZ());
    drifted[i].translation() = drifted[i - 1].translation() + (1 + drift.length) * (before * way_W);
    heading += drift.degrees_per_meter * way_W.norm() * M_PI / 180;
    const Eigen::AngleAxisd turn(heading, Eigen::Vector3d::UnitZ());
    drifted[i].linear() = turn.toRotationMatrix() * T_W_C[i].linear();
  }
  return drifted;
}

}  // namespace vismap
