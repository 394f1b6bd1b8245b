#include <gtest/gtest.h>

#include "freespace/coarsener.h"
#include "freespace/random_occupancy.h"

namespace vismap {
namespace {

using testing_support::Random;
using testing_support::RandomBlock;
using testing_support::RandomOccupancy;

/// The rule of CoarsenOptions, voxel by voxel.
CellState NaiveCell(const OccupancyMap& fine, VoxelIndex cell, const CoarsenOptions& options) {
  const int n = options.factor;
  int free = 0;
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const CellState state = fine.At(VoxelIndex{cell.x * n + x, cell.y * n + y, cell.z * n + z});
        if (state == CellState::kOccupied) return CellState::kOccupied;
        free += state == CellState::kFree;
      }
    }
  }
  return free >= options.free_fraction * n * n * n - 1e-6 ? CellState::kFree : CellState::kUnknown;
}

/// Like a real map, mostly free blocks and a few mixed ones. Among random blocks alone hardly any
/// cell would be free.
OccupancyMap MostlyFree(uint64_t seed) {
  Random random(seed);
  OccupancyMap map(0.01);
  for (int z = -3; z < 4; ++z) {
    for (int y = -5; y < 4; ++y) {
      for (int x = -4; x < 6; ++x) {
        const int kind = random.Below(12);
        if (kind == 0) continue;
        OccupancyPlanes planes = BlockOccupancy(CellState::kFree).Planes();
        if (kind == 1) planes.occupied[3] = uint64_t{1} << random.Below(64);
        if (kind == 2) planes.free[5] = random.Next();
        if (kind == 1) planes.free[3] &= ~planes.occupied[3];
        map.Set({x, y, z}, kind == 3 ? RandomBlock(&random) : BlockOccupancy(planes));
      }
    }
  }
  return map;
}

TEST(Coarsen, EqualsTheNaiveRuleForEveryFactor) {
  const OccupancyMap fine = MostlyFree(5);
  for (const CoarsenOptions options :
       {CoarsenOptions{1, 1.0}, CoarsenOptions{2, 1.0}, CoarsenOptions{3, 1.0},
        CoarsenOptions{5, 1.0}, CoarsenOptions{5, 0.9}, CoarsenOptions{8, 0.5},
        CoarsenOptions{11, 1.0}, CoarsenOptions{16, 0.7}}) {
    const OccupancyMap coarse = Coarsen(fine, options);
    const int reach = 60 / options.factor;
    std::array<int, 3> seen{};
    for (int z = -reach; z < reach; ++z) {
      for (int y = -reach; y < reach; ++y) {
        for (int x = -reach; x < reach; ++x) {
          const CellState expected = NaiveCell(fine, {x, y, z}, options);
          ASSERT_EQ(coarse.At(VoxelIndex{x, y, z}), expected)
              << "factor " << options.factor << " at " << x << " " << y << " " << z;
          ++seen[static_cast<size_t>(expected)];
        }
      }
    }
    EXPECT_GT(seen[0], 0);
    EXPECT_GT(seen[1], 0);
    EXPECT_GT(seen[2], 0);
  }
}

/// A block as maps have them: most often only a few voxels differ from free space.
BlockOccupancy AnyBlock(Random* random) {
  const int kind = random->Below(8);
  if (kind < 3) return BlockOccupancy(static_cast<CellState>(kind));
  if (kind == 3) return RandomBlock(random);
  OccupancyPlanes planes = BlockOccupancy(CellState::kFree).Planes();
  for (int i = 0; i < 3; ++i) {
    const int voxel = random->Below(kBlockVoxels);
    const uint64_t bit = uint64_t{1} << (voxel % 64);
    planes.free[static_cast<size_t>(voxel) / 64] &= ~bit;
    if (kind > 5) planes.occupied[static_cast<size_t>(voxel) / 64] |= bit;
  }
  return BlockOccupancy(planes);
}

TEST(Coarsener, EqualsCoarsenOfTheWholeMapAfterEveryChange) {
  for (const CoarsenOptions options :
       {CoarsenOptions{1, 1.0}, CoarsenOptions{2, 1.0}, CoarsenOptions{3, 1.0},
        CoarsenOptions{4, 1.0}, CoarsenOptions{5, 1.0}, CoarsenOptions{5, 0.9},
        CoarsenOptions{6, 1.0}, CoarsenOptions{7, 1.0}, CoarsenOptions{8, 1.0},
        CoarsenOptions{13, 1.0}, CoarsenOptions{16, 1.0}, CoarsenOptions{17, 1.0}}) {
    OccupancyMap fine = MostlyFree(6);
    Coarsener coarsener(fine.cell_size(), options);
    OccupancyMap follower(coarsener.coarse().cell_size());
    ASSERT_TRUE(follower.Apply(coarsener.Update(fine, fine.SortedIndices())));
    ASSERT_EQ(coarsener.coarse().Digest(), Coarsen(fine, options).Digest());
    Random random(7);
    for (int round = 0; round < 30; ++round) {
      std::vector<BlockIndex> changed;
      for (int i = 0; i < 5; ++i) {
        changed.push_back({random.Below(14) - 7, random.Below(14) - 7, random.Below(9) - 4});
        fine.Set(changed.back(), AnyBlock(&random));
      }
      const OccupancyDelta delta = coarsener.Update(fine, changed);
      ASSERT_EQ(coarsener.coarse().Digest(), Coarsen(fine, options).Digest())
          << "factor " << options.factor << ", round " << round;
      ASSERT_TRUE(follower.Apply(delta));
      ASSERT_EQ(follower.Digest(), coarsener.coarse().Digest());
    }
  }
}

}  // namespace
}  // namespace vismap
