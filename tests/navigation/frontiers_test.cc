#include "navigation/frontiers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <vector>

#include "base/parallel.h"
#include "navigation/inflate.h"
#include "navigation/random_leaves.h"

namespace vismap {
namespace {

using testing_support::RandomLeaves;

std::vector<Frontier> FrontiersOf(const OccupancyMap& leaves, const FrontierOptions& options = {}) {
  const auto inflated = Inflate(leaves, {0.1, UnknownPolicy::kOccupied});
  return FindFrontiers(leaves, *inflated, options).value();
}

bool IsFrontier(const OccupancyMap& leaves, VoxelIndex at) {
  if (leaves.At(at) != CellState::kFree) return false;
  for (const auto& [x, y, z] : std::vector<std::array<int, 3>>{
           {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}) {
    if (leaves.At(VoxelIndex{at.x + x, at.y + y, at.z + z}) == CellState::kUnknown) return true;
  }
  return false;
}

TEST(Frontiers, AreAllFreeLeavesBesideUnknownOnesOnce) {
  const OccupancyMap leaves = RandomLeaves(3, 3);
  FrontierOptions options;
  options.min_leaves = 1;
  std::set<VoxelIndex> found;
  for (const Frontier& frontier : FrontiersOf(leaves, options)) {
    for (const VoxelIndex& leaf : frontier.leaves) EXPECT_TRUE(found.insert(leaf).second);
  }
  for (int z = -32; z < 32; ++z) {
    for (int y = -32; y < 32; ++y) {
      for (int x = -32; x < 32; ++x)
        ASSERT_EQ(found.contains({x, y, z}), IsFrontier(leaves, {x, y, z})) << x << y << z;
    }
  }
  EXPECT_GT(found.size(), 1000u);
}

/// A closed box of 2 m, free inside, with a window of 0.4 m in the wall at x = 1 m.
OccupancyMap BoxWithWindow() {
  OccupancyMap leaves(0.05);
  for (int z = -3; z < 3; ++z) {
    for (int y = -3; y < 3; ++y) {
      for (int x = -3; x < 3; ++x) {
        OccupancyPlanes planes;
        for (int i = 0; i < kBlockVoxels; ++i) {
          const int cx = 8 * x + i % 8, cy = 8 * y + i / 8 % 8, cz = 8 * z + i / 64;
          const auto at = [](int a) { return a >= 0 ? a : -a - 1; };
          const int far = std::max({at(cx), at(cy), at(cz)});
          const bool window = cx == 20 && at(cy) < 4 && at(cz) < 4;
          const uint64_t bit = uint64_t{1} << (i % 64);
          if (far < 20 || window) planes.free[static_cast<size_t>(i / 64)] |= bit;
          if (far == 20 && !window) planes.occupied[static_cast<size_t>(i / 64)] |= bit;
        }
        leaves.Set({x, y, z}, BlockOccupancy(planes));
      }
    }
  }
  return leaves;
}

TEST(Frontiers, WindowIsFoundWithItsSizeCentreAndViewpoint) {
  const OccupancyMap leaves = BoxWithWindow();
  const std::vector<Frontier> frontiers = FrontiersOf(leaves, {.cluster_m = 4});
  size_t size = 0;
  for (const Frontier& frontier : frontiers) size += frontier.leaves.size();
  EXPECT_EQ(size, 64u);
  for (const Frontier& frontier : frontiers) {
    EXPECT_NEAR(frontier.center_W.x(), 1.025, 1e-9);
    ASSERT_TRUE(frontier.viewpoint_W);
    EXPECT_NEAR((*frontier.viewpoint_W - frontier.member_W).norm(), 1, 0.1);
    EXPECT_LT(frontier.viewpoint_W->x(), 0.9);
  }
}

TEST(Frontiers, ClustersStayWithinTheirCubes) {
  for (const Frontier& frontier : FrontiersOf(RandomLeaves(4, 4), {.cluster_m = 0.4})) {
    EXPECT_GE(frontier.leaves.size(), 8u);
    for (const VoxelIndex& leaf : frontier.leaves)
      EXPECT_EQ(BlockOf(leaf), BlockOf(frontier.leaves[0]));
  }
}

TEST(Frontiers, OrderDoesNotDependOnThreads) {
  const OccupancyMap leaves = RandomLeaves(5, 3);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return FrontiersOf(leaves);
  };
  const std::vector<Frontier> one = with(1), two = with(2);
  ASSERT_EQ(one.size(), two.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].leaves, two[i].leaves);
    EXPECT_EQ(one[i].viewpoint_W, two[i].viewpoint_W);
    if (i > 0) {
      EXPECT_GE(one[i - 1].leaves.size(), one[i].leaves.size());
    }
  }
}

TEST(Frontiers, RefusesOptionsOutOfRange) {
  const OccupancyMap leaves(0.05);
  EXPECT_THAT(FindFrontiers(leaves, leaves, {.cluster_m = 0}).error().message,
              ::testing::HasSubstr("cluster_m"));
  EXPECT_THAT(FindFrontiers(leaves, leaves, {.min_view_m = 3}).error().message,
              ::testing::HasSubstr("best_view_m"));
  EXPECT_TRUE(FindFrontiers(leaves, leaves, {})->empty());
}

}  // namespace
}  // namespace vismap
