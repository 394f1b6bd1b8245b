#include "navigation/tree_leaves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "freespace/octree.h"
#include "navigation/random_leaves.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::RandomLeaves;

OctreeBytes TreeOf(const OccupancyMap& voxels, UnknownPolicy unknown) {
  OctreeOptions options;
  options.resolution_m = 2 * voxels.cell_size();
  options.unknown = unknown;
  const auto tree = BuildOctree(voxels, options);
  if (!tree) throw std::runtime_error(tree.error().message);
  return *tree;
}

TEST(ReadTreeLeaves, GivesTheLeavesThatTheTreeWasMadeOf) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const OccupancyMap leaves = RandomLeaves(seed, 3, 0.1);
    OccupancyMap voxels(0.05);  // each leaf is 2x2x2 voxels
    for (const BlockIndex block : leaves.SortedIndices()) {
      for (int child = 0; child < 8; ++child) {
        const int dx = child & 1, dy = (child >> 1) & 1, dz = child >> 2;
        OccupancyPlanes planes;
        for (int i = 0; i < kBlockVoxels; ++i) {
          const int x = i & 7, y = (i >> 3) & 7, z = i >> 6;
          const CellState state =
              leaves.At(block).At(LinearIndex(4 * dx + x / 2, 4 * dy + y / 2, 4 * dz + z / 2));
          const auto at = static_cast<size_t>(LinearIndex(x, y, z));
          const uint64_t bit = uint64_t{1} << (at % 64);
          if (state == CellState::kFree) planes.free[at / 64] |= bit;
          if (state == CellState::kOccupied) planes.occupied[at / 64] |= bit;
        }
        voxels.Set({2 * block.x + dx, 2 * block.y + dy, 2 * block.z + dz}, BlockOccupancy(planes));
      }
    }
    const auto read = ReadTreeLeaves(TreeOf(voxels, UnknownPolicy::kAbsent).bytes, "tree");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->Digest(), leaves.Digest());
    const auto closed = ReadTreeLeaves(TreeOf(voxels, UnknownPolicy::kOccupied).bytes, "tree");
    ASSERT_TRUE(closed) << closed.error().message;
    const OccupancyBox box = *leaves.KnownCells();
    for (int z = box.min.z - 10; z < box.max.z + 10; ++z) {
      for (int x = box.min.x - 10; x < box.max.x + 10; ++x) {
        const VoxelIndex cell{x, 1, z};
        EXPECT_EQ(closed->At(cell) == CellState::kFree, leaves.At(cell) == CellState::kFree);
        EXPECT_NE(closed->At(cell), CellState::kUnknown);
      }
    }
  }
}

TEST(ReadTreeLeaves, RefusesDamagedTreesAndThoseThatCoverTooMuch) {
  OctreeBytes tree = TreeOf(RandomLeaves(1, 1), UnknownPolicy::kAbsent);
  tree.bytes.pop_back();
  const auto cut = ReadTreeLeaves(tree.bytes, "the tree");
  ASSERT_FALSE(cut);
  EXPECT_THAT(cut.error().message, HasSubstr("the tree: the nodes are damaged or cut"));
  const std::string header = "# Octomap OcTree binary file\nid OcTree\nsize 2\nres 0.05\ndata\n";
  const std::string all = header + std::string("\x01\x00", 2);  // one child of the root is free
  const auto bomb =
      ReadTreeLeaves({reinterpret_cast<const uint8_t*>(all.data()), all.size()}, "the tree");
  ASSERT_FALSE(bomb);
  EXPECT_THAT(bomb.error().message, HasSubstr("covers more than 1048576 blocks"));
  const auto empty = ReadTreeLeaves(TreeOf(OccupancyMap(0.05), UnknownPolicy::kAbsent).bytes, "");
  ASSERT_TRUE(empty) << empty.error().message;
  EXPECT_EQ(empty->size(), 0u);
}

}  // namespace
}  // namespace vismap
