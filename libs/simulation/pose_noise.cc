#include "simulation/pose_noise.h"

#include <cmath>

#include "base/random.h"
#include "base/require.h"

namespace vismap {
namespace {

/// Three independent normal numbers of deviation 1.
Eigen::Vector3d NormalVector(uint64_t key) {
  return {Normal(Mix(key, 1)), Normal(Mix(key, 2)), Normal(Mix(key, 3))};
}

}  // namespace

Pose AddPoseNoise(const Pose& T_W_C, const PoseNoise& noise, uint64_t key) {
  Require(noise.deviation >= 0 && noise.degrees_per_cm >= 0, "pose errors are not negative");
  if (noise.deviation == 0) return T_W_C;
  const double radians = noise.degrees_per_cm * 100 * noise.deviation * M_PI / 180;
  const Eigen::Vector3d turn = radians * NormalVector(Mix(key, 1));
  Pose noisy = T_W_C;
  noisy.translation() += noise.deviation * NormalVector(Mix(key, 2));
  if (turn.norm() > 0)
    noisy.linear() *= Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  return noisy;
}

}  // namespace vismap
