#include "geometry/pose_correction.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/require.h"

namespace vismap {
namespace {

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return cross;
}

/// The integral of the rotations exp(s * rotation) over s in [0, 1]: by it, a constant velocity in
/// the moving body becomes the way of its origin. `rotation`: axis times angle.
Eigen::Matrix3d MeanRotation(const Eigen::Vector3d& rotation) {
  const double angle = rotation.norm(), squared = angle * angle;
  const double half = std::sin(angle / 2);
  // (1 - cos) / angle^2 and (angle - sin) / angle^3, where they are not 0/0.
  const double first = angle < 1e-8 ? 0.5 : 2 * half * half / squared;
  const double second = angle < 1e-2 ? 1.0 / 6 - squared / 120 + squared * squared / 5040
                                     : (angle - std::sin(angle)) / (squared * angle);
  const Eigen::Matrix3d cross = CrossMatrix(rotation);
  return Eigen::Matrix3d::Identity() + first * cross + second * cross * cross;
}

}  // namespace

Pose PartOfMotion(const Pose& motion, double part) {
  const Eigen::AngleAxisd rotation(motion.linear());
  const Eigen::Vector3d turn = rotation.angle() * rotation.axis();
  const Eigen::Vector3d velocity = MeanRotation(turn).inverse() * motion.translation();
  Pose made = Pose::Identity();
  made.linear() = Eigen::AngleAxisd(part * rotation.angle(), rotation.axis()).toRotationMatrix();
  made.translation() = MeanRotation(part * turn) * (part * velocity);
  return made;
}

std::vector<Pose> InterpolateCorrections(std::span<const PoseAtTime> frames,
                                         std::span<const PoseAtTime> corrected) {
  Require(!corrected.empty(), "there is a corrected pose");
  std::map<int64_t, Pose> old_poses;
  for (const PoseAtTime& frame : frames) old_poses.emplace(frame.utime, frame.T_W_C);
  std::vector<Pose> corrections;
  for (const PoseAtTime& known : corrected)
    corrections.push_back(known.T_W_C * old_poses.at(known.utime).inverse());
  std::vector<Pose> poses;
  for (const PoseAtTime& frame : frames) {
    const auto later = std::lower_bound(
        corrected.begin(), corrected.end(), frame.utime,
        [](const PoseAtTime& known, int64_t utime) { return known.utime < utime; });
    const auto j = static_cast<size_t>(later - corrected.begin());
    if (later != corrected.end() && later->utime == frame.utime) {
      poses.push_back(later->T_W_C);
    } else if (j == 0 || later == corrected.end()) {
      poses.push_back((j == 0 ? corrections.front() : corrections.back()) * frame.T_W_C);
    } else {
      const double part = static_cast<double>(frame.utime - corrected[j - 1].utime) /
                          static_cast<double>(later->utime - corrected[j - 1].utime);
      const Pose between = corrections[j - 1].inverse() * corrections[j];
      poses.push_back(corrections[j - 1] * PartOfMotion(between, part) * frame.T_W_C);
    }
  }
  return poses;
}

}  // namespace vismap
