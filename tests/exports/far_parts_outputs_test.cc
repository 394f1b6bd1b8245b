#include <gtest/gtest.h>

#include "exports/outputs.h"
#include "mapping/integrate.h"
#include "support/plane_frames.h"

namespace vismap {
namespace {

using testing_support::LookAtWall;

struct Mapped {
  SemanticMap map{VoxelGridOptions{0.02, 4}};
  MapMetadata metadata;

  void Add(const Eigen::Vector3d& position) {
    const SegmentedFrame frame = LookAtWall(position.z() + 1.2, position);
    IntegrateFrame(frame, Associate(frame, {map.voxels, map.labels}, {}), {}, &map);
    metadata.trajectory.push_back({map.revision, CameraId{0}, frame.frame.header.T_W_C});
  }
};

TEST(FarPartsOfOutputs, AreInNoMeshAndNoOctree) {
  Mapped near, both;
  for (int i = 0; i < 12; ++i) {
    near.Add({0, 0, 0});
    both.Add({0, 0, 0});
    if (i == 5) both.Add({300, 0, 0});
  }
  const MapProducts alone = MakeProducts(near.map, near.metadata, {});
  const MapProducts products = MakeProducts(both.map, both.metadata, {});
  ASSERT_GT(alone.mesh.triangles.size(), 1000u);
  EXPECT_EQ(products.mesh.vertices.size(), alone.mesh.vertices.size());
  EXPECT_EQ(products.mesh.triangles, alone.mesh.triangles);
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    EXPECT_EQ(MakeOctree(both.map, both.metadata, {}, unknown)->bytes,
              MakeOctree(near.map, near.metadata, {}, unknown)->bytes);
  }
  EXPECT_GT(both.map.voxels.size(), near.map.voxels.size()) << "the map itself keeps them";
}

}  // namespace
}  // namespace vismap
