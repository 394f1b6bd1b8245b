#pragma once

#include "support/analytic_map.h"

namespace vismap::testing_support {

inline constexpr VoxelGridOptions kSphereGrid{.voxel_size_m = 0.02, .truncation_voxels = 4};

/// A cube around the origin of W whose edges have length 2 `half` [m].
inline AnalyticRegion CubeRegion(double half, int observations = 5) {
  return {.min_W = Eigen::Vector3d::Constant(-half),
          .max_W = Eigen::Vector3d::Constant(half),
          .observations = observations};
}

// Not on the lattice, so that the surface does not coincide with borders of voxels or blocks.
inline const Eigen::Vector3d kSphereCenter(0.013, -0.027, 0.031);
inline constexpr double kSphereRadius = 0.31;

/// The map of a coloured sphere: label 1 on the side of lower x, label 2 on the other.
inline SemanticMap SphereMap() {
  const AnalyticScene scene{
      .distance =
          [](const Eigen::Vector3d& p) { return SphereDistance(p, kSphereCenter, kSphereRadius); },
      .label =
          [](const Eigen::Vector3d& p) {
            return p.x() < kSphereCenter.x() ? SegmentLabel{1} : SegmentLabel{2};
          },
      .color =
          [](const Eigen::Vector3d&) {
            return Rgb8{10, 200, 30};
          }};
  return MakeAnalyticMap(scene, CubeRegion(0.6), kSphereGrid);
}

}  // namespace vismap::testing_support
