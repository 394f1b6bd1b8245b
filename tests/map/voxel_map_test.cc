#include "map/voxel_map.h"

#include <gtest/gtest.h>

#include "support/voxel_reading.h"

namespace vismap {
namespace {

using testing_support::ReadVoxel;
using testing_support::VoxelAt;
using testing_support::VoxelCenter;

TEST(VoxelMap, VoxelsOfNegativeCoordinatesFallInTheRightBlock) {
  const VoxelMap map({0.01, 4});
  const VoxelIndex voxel = VoxelAt(map, {-0.001, 0.005, -0.085});
  EXPECT_EQ(voxel, (VoxelIndex{-1, 0, -9}));
  EXPECT_EQ(BlockOf(voxel), (BlockIndex{-1, 0, -2}));
  EXPECT_EQ(OffsetInBlock(voxel), LinearIndex(7, 0, 7));
  EXPECT_NEAR((VoxelCenter(map, voxel) - Eigen::Vector3d(-0.005, 0.005, -0.085)).norm(), 0, 1e-12);
}

TEST(VoxelMap, TellsUnseenFromSeenEmpty) {
  VoxelMap map({0.01, 4});
  EXPECT_FALSE(ReadVoxel(map, VoxelIndex{0, 0, 0}));
  Block& block = map.FindOrCreate({0, 0, 0});
  EXPECT_FALSE(ReadVoxel(map, VoxelIndex{0, 0, 0}));
  block.free = std::make_unique<FreeVoxels>();
  block.free->once[0] = 1;
  ASSERT_TRUE(ReadVoxel(map, VoxelIndex{0, 0, 0}));
  EXPECT_EQ(ReadVoxel(map, VoxelIndex{0, 0, 0})->observations, 1);
  EXPECT_FALSE(ReadVoxel(map, VoxelIndex{1, 0, 0}));
  block.free.reset();
  block.all_free = true;
  EXPECT_EQ(ReadVoxel(map, VoxelIndex{1, 0, 0})->observations, 2);
  EXPECT_FLOAT_EQ(ReadVoxel(map, VoxelIndex{1, 0, 0})->distance, 0.04F);
}

TEST(VoxelMap, ListsBlocksInAscendingOrder) {
  VoxelMap map({0.01, 4});
  for (int i = 0; i < 200; ++i) map.FindOrCreate({(i * 37) % 11 - 5, (i * 17) % 13 - 6, i % 7 - 3});
  const std::vector<BlockIndex> indices = map.SortedIndices();
  EXPECT_EQ(indices.size(), map.size());
  EXPECT_TRUE(std::is_sorted(indices.begin(), indices.end()));
}

}  // namespace
}  // namespace vismap
