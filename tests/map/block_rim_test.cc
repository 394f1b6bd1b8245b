#include "map/block_rim.h"

#include <gtest/gtest.h>

#include "support/random_scenes.h"

namespace vismap {
namespace {

// Along one axis: whether voxel `at` (0..7) of this block lies in the block at `neighbour` (-1..1)
// or in the rim of that block.
bool Sees(int neighbour, int at) {
  const int there = at - kBlockSide * neighbour;
  return there >= -kRimBelow && there < kBlockSide + kRimAbove;
}

NeighbourBits NaiveAffectedBy(const VoxelBits& voxels) {
  NeighbourBits affected = 0;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        for (int i = 0; i < kBlockVoxels; ++i) {
          const bool is_set = voxels[static_cast<size_t>(i) / 64] >> (i % 64) & 1;
          if (is_set && Sees(x, i & 7) && Sees(y, i >> 3 & 7) && Sees(z, i >> 6))
            affected |= NeighbourBits{1} << NeighbourSlot(x, y, z);
        }
      }
    }
  }
  return affected;
}

TEST(AffectedBy, EqualsTheNaiveOne) {
  EXPECT_EQ(AffectedBy({}), 0u);
  testing_support::RandomNumbers random(5);
  for (int round = 0; round < 500; ++round) {
    VoxelBits voxels{};
    for (int i = random.Whole(1, 4); i > 0; --i) {
      const int voxel = random.Whole(0, kBlockVoxels - 1);
      voxels[static_cast<size_t>(voxel) / 64] |= uint64_t{1} << (voxel % 64);
    }
    EXPECT_EQ(AffectedBy(voxels), NaiveAffectedBy(voxels));
  }
}

TEST(AffectedBy, WholeBlocksAffectAllAroundThem) {
  VoxelBits all;
  all.fill(~uint64_t{0});
  EXPECT_EQ(AffectedBy(all), kAllNeighbours);
}

TEST(AffectedBy, VoxelsInsideAffectTheirBlockAlone) {
  VoxelBits one{};
  one[3] = uint64_t{1} << (4 + 8 * 5);
  EXPECT_EQ(AffectedBy(one), NeighbourBits{1} << NeighbourSlot(0, 0, 0));
}

}  // namespace
}  // namespace vismap
