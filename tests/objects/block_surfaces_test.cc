#include "objects/block_surfaces.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "association/associate.h"
#include "mapping/integrate.h"
#include "objects/label_surfaces.h"
#include "objects/map_mesh.h"
#include "objects/read_out.h"
#include "support/mesh_blocks.h"
#include "support/plane_frames.h"

namespace vismap {
namespace {

using testing_support::MeshBlocks;

/// A map of a wall with two segments, seen from several positions that are off the voxel grid along
/// all axes.
SemanticMap MapOfWall(int frames) {
  SemanticMap map({0.02, 4});
  for (int i = 0; i < frames; ++i) {
    SegmentedFrame frame = testing_support::LookAtWall(1.5, {0.1 * i, 0.05 * i, 0.013 * i});
    testing_support::SplitAtColumn(70 - 9 * i, frame);
    const FrameAssociation association = Associate(frame, {map.voxels, map.labels}, {});
    IntegrateFrame(frame, association, {}, &map);
  }
  return map;
}

void UpdateAll(const SemanticMap& map, BlockSurfaces* surfaces) {
  for (const BlockMesh& block : MeshBlocks(map, map.voxels.SortedIndices(), ShowLabels(map.labels)))
    surfaces->Update(block, map.voxels.voxel_size());
}

TEST(BlockSurfaces, HoldWhatTheWholeMeshHas) {
  const SemanticMap map = MapOfWall(4);
  const size_t labels = Raw(map.labels.next_label());
  const LabelSurfaces whole =
      CollectSurfaces(ExtractMesh(map, {.min_component_triangles = 0}), labels);
  BlockSurfaces surfaces;
  UpdateAll(map, &surfaces);
  const double voxel = map.voxels.voxel_size();
  for (size_t label = 0; label < labels; ++label) {
    const BlockSurfaces::Amount amount = surfaces.AmountOf(static_cast<SegmentLabel>(label));
    // Vertices at the border of the observed space, on the face between two blocks, may be missing.
    EXPECT_LE(amount.vertices, whole[label].vertices) << label;
    EXPECT_GE(amount.vertices, whole[label].vertices - whole[label].vertices / 50) << label;
    EXPECT_NEAR(amount.area, whole[label].area, 1e-7) << label;
    std::vector<Eigen::Vector3f> points_W;
    for (const BlockIndex& block : surfaces.Blocks())
      surfaces.AddPoints(static_cast<SegmentLabel>(label), block, voxel, &points_W);
    EXPECT_LE(points_W.size(), whole[label].points_W.size());
    EXPECT_GE(4 * points_W.size(), whole[label].points_W.size());
    for (const Eigen::Vector3f& point : points_W) {
      const auto is_it = [&](const Eigen::Vector3f& vertex) {
        return (vertex - point).cwiseAbs().maxCoeff() <= voxel / 32;
      };
      EXPECT_TRUE(std::any_of(whole[label].points_W.begin(), whole[label].points_W.end(), is_it));
    }
  }
}

TEST(BlockSurfaces, NothingIsLeftOfBlocksThatLostTheirSurface) {
  const SemanticMap map = MapOfWall(3);
  BlockSurfaces surfaces;
  UpdateAll(map, &surfaces);
  const std::vector<BlockIndex> blocks = surfaces.Blocks();
  ASSERT_FALSE(blocks.empty());
  const uint32_t version = surfaces.AmountOf(SegmentLabel{1}).version;
  UpdateAll(map, &surfaces);  // the same again
  for (const BlockIndex& block : blocks) {
    EXPECT_TRUE(surfaces.Has(block));
    EXPECT_TRUE(surfaces.Update({block, {}}, map.voxels.voxel_size())) << "had one";
    EXPECT_FALSE(surfaces.Update({block, {}}, map.voxels.voxel_size())) << "had none";
    EXPECT_FALSE(surfaces.Has(block));
  }
  for (size_t label = 0; label < Raw(map.labels.next_label()); ++label) {
    EXPECT_EQ(surfaces.AmountOf(static_cast<SegmentLabel>(label)).vertices, 0);
    EXPECT_EQ(surfaces.AmountOf(static_cast<SegmentLabel>(label)).area, 0);
  }
  EXPECT_NE(surfaces.AmountOf(SegmentLabel{1}).version, version);
  EXPECT_EQ(surfaces.AmountOf(SegmentLabel{1000}).vertices, 0);
}

}  // namespace
}  // namespace vismap
