#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "support/analytic_map.h"

namespace vismap::testing_support {

inline constexpr VoxelGridOptions kGrid{.voxel_size_m = 0.02, .truncation_voxels = 4};
inline constexpr double kVoxel = 0.02;
inline const Eigen::Vector3d kBoxCenter(0.05, -0.3, 0.25);
inline const Eigen::Vector3d kBoxHalf(0.3, 0.15, 0.25);
inline constexpr double kYaw = 25 * std::numbers::pi / 180;
inline const Eigen::Vector3d kBallCenter(0.6, 0.6, 0.2);
inline constexpr SegmentLabel kFloor{1}, kBoxLeft{2}, kBoxRight{3}, kBall{4};
inline constexpr ClassId kChair{62}, kTv{72};

inline Eigen::Vector3d InBox(const Eigen::Vector3d& p) {
  return Eigen::AngleAxisd(-kYaw, Eigen::Vector3d::UnitZ()) * (p - kBoxCenter);
}

// A floor with a box on it, turned and of two segments, and a ball.
inline SemanticMap AnalyticRoom() {
  const auto box = [](const Eigen::Vector3d& p) {
    return BoxDistance(InBox(p), Eigen::Vector3d::Zero(), kBoxHalf);
  };
  const auto ball = [](const Eigen::Vector3d& p) { return SphereDistance(p, kBallCenter, 0.15); };
  const AnalyticScene scene{.distance =
                                [=](const Eigen::Vector3d& p) {
                                  return std::min({box(p), ball(p), p.z()});
                                },
                            .label =
                                [=](const Eigen::Vector3d& p) {
                                  if (p.z() < std::min(box(p), ball(p))) return kFloor;
                                  if (ball(p) < box(p)) return kBall;
                                  return InBox(p).x() < -0.1 ? kBoxLeft : kBoxRight;
                                }};
  SemanticMap map = MakeAnalyticMap(
      scene, {.min_W = Eigen::Vector3d(-0.8, -0.8, -0.1), .max_W = Eigen::Vector3d(0.9, 0.9, 0.7)},
      kGrid);
  AddEvidence(&map, kFloor, InstanceId::kNone, ClassId::kUnknown, 20, 0);
  AddEvidence(&map, kBoxLeft, InstanceId{5}, kTv, 10, 9);
  AddEvidence(&map, kBoxRight, InstanceId{5}, kChair, 20, 8);
  AddEvidence(&map, kBall, InstanceId::kNone, ClassId::kUnknown, 4, 0);
  return map;
}

}  // namespace vismap::testing_support
