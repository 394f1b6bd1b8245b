#include "freespace/octree_builder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "freespace/octomap_reference.h"
#include "freespace/random_occupancy.h"

// After any changes in any steps, the bytes equal those of BuildOctree for the whole map, and those
// of OctoMap's own writer.

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::OctomapBytes;
using testing_support::Random;
using testing_support::RandomBlock;
using testing_support::Text;

constexpr std::array kPolicies = {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied};

void ExpectSame(const Result<OctreeBytes>& a, const Result<OctreeBytes>& b) {
  ASSERT_TRUE(a);
  ASSERT_TRUE(b);
  ASSERT_EQ(a->bytes, b->bytes);
  EXPECT_EQ(a->nodes, b->nodes);
  EXPECT_EQ(a->resolution, b->resolution);
  EXPECT_EQ(a->unknown, b->unknown);
  EXPECT_EQ(a->bounds_W.min(), b->bounds_W.min());
  EXPECT_EQ(a->bounds_W.max(), b->bounds_W.max());
}

/// Mostly free, like real maps, so that nodes are pruned.
BlockOccupancy NextBlock(Random* random) {
  const int kind = random->Below(8);
  if (kind < 2) return BlockOccupancy(CellState::kUnknown);
  if (kind < 5) return BlockOccupancy(CellState::kFree);
  return RandomBlock(random);
}

/// Changes a few blocks in a box that moves away from the origin, so that the bounds grow, and
/// shrink when old blocks become unknown. Lists some blocks that did not change, and some twice.
std::vector<BlockIndex> Change(int step, Random* random, OccupancyMap* map) {
  std::vector<BlockIndex> changed;
  for (int i = random->Below(12); i >= 0; --i) {
    const BlockIndex index{random->Below(8) + step / 2 - 6, random->Below(10) - step / 4,
                           random->Below(6) - 3};
    map->Set(index, NextBlock(random));
    changed.push_back(index);
    if (random->Below(4) == 0) changed.push_back({random->Below(9), index.y, index.z});
    if (random->Below(4) == 0) changed.push_back(index);
  }
  if (step % 7 == 6) {
    for (const BlockIndex& index : map->SortedIndices()) {
      if (index.x > step / 2 - 4) continue;
      map->Set(index, BlockOccupancy(CellState::kUnknown));
      changed.push_back(index);
    }
  }
  return changed;
}

void CheckSequence(const OctreeOptions& options, uint64_t seed) {
  Random random(seed);
  OccupancyMap map(0.02);
  Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), options);
  ASSERT_TRUE(builder);
  for (int step = 0; step < 40; ++step) {
    builder->Update(map, Change(step, &random, &map));
    if (random.Below(4) == 0) continue;  // not every state is exported
    for (const UnknownPolicy unknown : kPolicies) {
      OctreeOptions whole = options;
      whole.unknown = unknown;
      ASSERT_NO_FATAL_FAILURE(ExpectSame(builder->Build(unknown), BuildOctree(map, whole)))
          << "step " << step << " resolution " << options.resolution_m;
    }
  }
}

TEST(OctreeBuilder, BytesAreThoseOfTheWholeMapAfterEveryStep) {
  uint64_t seed = 0;
  for (const double resolution : {0.04, 0.06, 0.08, 0.1, 0.22}) {
    for (const double free_fraction : {1.0, 0.6}) {
      OctreeOptions options;
      options.resolution_m = resolution;
      options.free_fraction = free_fraction;
      CheckSequence(options, ++seed);
    }
  }
}

TEST(OctreeBuilder, BytesAreThoseOfTheWholeMapWithinBounds) {
  OctreeOptions options;
  options.resolution_m = 0.06;
  options.bounds_W = {Eigen::Vector3d(-0.7, -0.4, -0.3), Eigen::Vector3d(1.3, 0.9, 0.27)};
  CheckSequence(options, 11);
}

TEST(OctreeBuilder, BytesAreThoseOfTheWholeMapWithoutAShell) {
  OctreeOptions options;
  options.resolution_m = 0.06;
  options.shell_m = 0;
  CheckSequence(options, 12);
}

TEST(OctreeBuilder, BytesAreThoseOfOctomapAfterEveryStep) {
  Random random(5);
  OccupancyMap leaves(0.05);
  OctreeCache cache;
  for (int step = 0; step < 30; ++step) {
    cache.Update(leaves, Change(step, &random, &leaves));
    const std::optional<OccupancyBox> box = leaves.KnownCells();
    if (!box) continue;
    for (const UnknownPolicy unknown : kPolicies) {
      const Result<OctreeBytes> octree =
          cache.Encode(leaves, {.resolution_m = 0.05, .unknown = unknown, .shell_m = 0});
      ASSERT_TRUE(octree);
      ASSERT_EQ(Text(octree->bytes), OctomapBytes(leaves, 0.05, unknown, *box)) << step;
    }
  }
}

TEST(OctreeBuilder, IsTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<uint8_t>> bytes;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    Random random(8);
    OccupancyMap map(0.02);
    Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), {});
    std::vector<uint8_t> all;
    for (int step = 0; step < 20; ++step) {
      builder->Update(map, Change(step, &random, &map));
      for (const UnknownPolicy unknown : kPolicies) {
        const Result<OctreeBytes> octree = builder->Build(unknown);
        all.insert(all.end(), octree->bytes.begin(), octree->bytes.end());
      }
    }
    bytes.push_back(all);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[0], bytes[2]);
}

TEST(OctreeBuilder, WritesAgainOnlyWhatChangedHoweverLargeTheMap) {
  OccupancyMap map(0.02);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 60; ++x) map.Set({x, y, (x + y) % 9}, BlockOccupancy(CellState::kFree));
  }
  OctreeOptions options;
  options.resolution_m = 0.04;
  Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), options);
  builder->Update(map, map.SortedIndices());
  for (const UnknownPolicy unknown : kPolicies) {
    ASSERT_TRUE(builder->Build(unknown));
    EXPECT_GT(builder->encoded_cubes(), 60);
    ASSERT_TRUE(builder->Build(unknown));
    EXPECT_EQ(builder->encoded_cubes(), 0);
  }
  const BlockIndex inside{30, 30, 1};
  map.Set(inside, BlockOccupancy(CellState::kOccupied));
  builder->Update(map, std::array{inside});
  for (const UnknownPolicy unknown : kPolicies) {
    ASSERT_TRUE(builder->Build(unknown));
    EXPECT_EQ(builder->encoded_cubes(), 1);
  }
  // One side of the bounds moves: all other cubes stay as they are, since what lies outside of the
  // bounds is as occupied as what is unknown.
  const BlockIndex beyond{62, 30, 1};
  map.Set(beyond, BlockOccupancy(CellState::kFree));
  builder->Update(map, std::array{beyond});
  ASSERT_TRUE(builder->Build(UnknownPolicy::kAbsent));
  EXPECT_EQ(builder->encoded_cubes(), 1);
  ASSERT_TRUE(builder->Build(UnknownPolicy::kOccupied));
  EXPECT_EQ(builder->encoded_cubes(), 1);
}

TEST(OctreeBuilder, LeavesOutWhatLiesBeyondTheKeySpace) {
  OccupancyMap map(0.02);
  Result<OctreeBuilder> builder = OctreeBuilder::Make(map.cell_size(), {});
  const BlockIndex near{3, 4, 5};
  const BlockIndex far{3 * 4096, 0, 0};
  map.Set(near, BlockOccupancy(CellState::kFree));
  builder->Update(map, map.SortedIndices());
  const Result<OctreeBytes> alone = builder->Build(UnknownPolicy::kAbsent);
  ASSERT_TRUE(alone);
  EXPECT_EQ(alone->left_out, "");
  map.Set(far, BlockOccupancy(CellState::kOccupied));
  builder->Update(map, std::array{far});
  const Result<OctreeBytes> tree = builder->Build(UnknownPolicy::kAbsent);
  ASSERT_TRUE(tree);
  EXPECT_EQ(tree->bytes, alone->bytes);
  EXPECT_THAT(tree->left_out, HasSubstr("1 pieces of the map"));
  EXPECT_THAT(tree->left_out, HasSubstr("beyond the 1966.08 m"));
  map.Set(far, BlockOccupancy(CellState::kUnknown));
  builder->Update(map, std::array{far});
  EXPECT_EQ(builder->Build(UnknownPolicy::kAbsent)->left_out, "");
  ExpectSame(builder->Build(UnknownPolicy::kAbsent), BuildOctree(map, {}));
}

TEST(OctreeBuilder, RefusesAMapOfWhichAllLiesBeyondTheKeySpace) {
  OccupancyMap map(0.02);
  map.Set({3 * 4096, 0, 0}, BlockOccupancy(CellState::kOccupied));
  const Result<OctreeBytes> refused = BuildOctree(map, {});
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("all of the map lies beyond the 1966.08 m"));
}

TEST(OctreeBuilder, RefusesWhatBuildOctreeRefuses) {
  OctreeOptions options;
  options.resolution_m = 0.05;
  EXPECT_FALSE(OctreeBuilder::Make(0.02, options));
  EXPECT_TRUE(OctreeBuilder::Make(0.01, options));
  options.free_fraction = 1.1;
  EXPECT_FALSE(OctreeBuilder::Make(0.01, options));
}

}  // namespace
}  // namespace vismap
