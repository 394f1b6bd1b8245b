#include "objects/map_mesh.h"

#include <gtest/gtest.h>

#include "support/analytic_map.h"

namespace vismap {
namespace {

using namespace testing_support;
using Eigen::Vector3d;

constexpr VoxelGridOptions kGrid{.voxel_size = 0.02, .truncation_voxels = 4};

AnalyticRegion Region(double half, int observations = 5) {
  return {.min_W = Vector3d::Constant(-half),
          .max_W = Vector3d::Constant(half),
          .observations = observations};
}

// Off the lattice, so that no block or voxel border is special.
const Vector3d kCenter(0.013, -0.027, 0.031);
constexpr double kRadius = 0.31;

SemanticMap SphereMap() {
  const AnalyticScene scene{
      .distance = [](const Vector3d& p) { return SphereDistance(p, kCenter, kRadius); },
      .label =
          [](const Vector3d& p) { return p.x() < kCenter.x() ? SegmentLabel{1} : SegmentLabel{2}; },
      .color =
          [](const Vector3d&) {
            return Rgb8{10, 200, 30};
          }};
  return MakeAnalyticMap(scene, Region(0.6), kGrid);
}

TEST(ExtractMesh, InstanceAndClassComeFromTheEvidence) {
  SemanticMap map = SphereMap();
  AddEvidence(&map, SegmentLabel{1}, InstanceId{7}, ClassId{62}, 10, 9);
  AddEvidence(&map, SegmentLabel{2}, InstanceId{0}, ClassId{0}, 10, 0);
  for (const MeshVertex& vertex : ExtractMesh(map).vertices) {
    const bool left = vertex.segment == SegmentLabel{1};
    EXPECT_EQ(vertex.instance, left ? InstanceId{7} : InstanceId::kNone);
    EXPECT_EQ(vertex.class_id, left ? ClassId{62} : ClassId::kUnknown);
  }
}

}  // namespace
}  // namespace vismap
