#include "viewer/leaves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "freespace/octree.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr double kVoxel = 0.05;

OccupancyMap RandomSpace(uint64_t seed) {
  testing_support::RandomNumbers random(seed);
  OccupancyMap map(kVoxel);
  for (int i = 0; i < 60; ++i) {
    const BlockIndex block{random.Whole(-3, 3), random.Whole(-3, 3), random.Whole(-2, 2)};
    if (random.Chance(0.7)) {
      map.Set(block, BlockOccupancy(random.Chance(0.8) ? CellState::kFree : CellState::kOccupied));
      continue;
    }
    OccupancyPlanes planes;
    planes.free.fill(~uint64_t{0});
    const auto layer = static_cast<size_t>(random.Whole(0, 7));
    planes.free[layer] = 0;
    planes.occupied[layer] = ~uint64_t{0};
    map.Set(block, BlockOccupancy(planes));
  }
  return map;
}

OctreeBytes TreeOf(const OccupancyMap& map, UnknownPolicy unknown) {
  OctreeOptions options;
  options.resolution_m = 2 * kVoxel;
  options.unknown = unknown;
  options.shell_m = unknown == UnknownPolicy::kOccupied ? 0.5 : 0;
  return *BuildOctree(map, options);
}

bool Covers(const TreeLeaf& leaf, const Eigen::Vector3d& p_W) {
  for (size_t i = 0; i < 3; ++i) {
    if (std::abs(p_W[static_cast<Eigen::Index>(i)] - leaf.center_W[i]) > leaf.size_m / 2)
      return false;
  }
  return true;
}

/// The state of a leaf by its voxels.
CellState StateOf(const OccupancyMap& map, const Eigen::Vector3d& center_W) {
  int free = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d side(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    const CellState state = map.At(Eigen::Vector3d(center_W + side * (kVoxel / 2)));
    if (state == CellState::kOccupied) return state;
    free += state == CellState::kFree ? 1 : 0;
  }
  return free == 8 ? CellState::kFree : CellState::kUnknown;
}

TEST(Leaves, OfAPlaneAreThoseOfTheMap) {
  size_t compared = 0, large = 0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const OccupancyMap map = RandomSpace(seed);
    const OctreeBytes tree = TreeOf(map, UnknownPolicy::kAbsent);
    for (int axis = 0; axis < 3; ++axis) {
      const double at = 0.1 * static_cast<double>(seed) + 0.03;
      const LeafCut cut = *CutLeaves(tree.bytes, axis, at);
      EXPECT_EQ(cut.leaf_m, 2 * kVoxel);
      EXPECT_EQ(cut.left_out, 0u);
      for (const TreeLeaf& leaf : cut.leaves) large += leaf.size_m > cut.leaf_m ? 1 : 0;
      for (int u = -20; u < 20; ++u) {
        for (int v = -20; v < 20; ++v) {
          Eigen::Vector3d p_W;
          p_W[axis] = (std::floor(at / cut.leaf_m) + 0.5) * cut.leaf_m;
          p_W[axis == 0 ? 1 : 0] = (u + 0.5) * cut.leaf_m;
          p_W[axis == 2 ? 1 : 2] = (v + 0.5) * cut.leaf_m;
          CellState found = CellState::kUnknown;
          int covered = 0;
          for (const TreeLeaf& leaf : cut.leaves) {
            if (!Covers(leaf, p_W)) continue;
            ++covered;
            found = leaf.occupied ? CellState::kOccupied : CellState::kFree;
          }
          ASSERT_LE(covered, 1);
          ASSERT_EQ(found, StateOf(map, p_W)) << p_W.transpose();
          compared += found != CellState::kUnknown ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(compared, 500u);
  EXPECT_GT(large, 50u);
}

TEST(Leaves, AClosedTreeHasNoUnknownSpaceInItsBounds) {
  const LeafCut cut = *CutLeaves(TreeOf(RandomSpace(1), UnknownPolicy::kOccupied).bytes, 2, 0.03);
  for (double u = -0.95; u < 1; u += 0.1) {
    for (double v = -0.95; v < 1; v += 0.1) {
      EXPECT_TRUE(std::any_of(cut.leaves.begin(), cut.leaves.end(), [&](const TreeLeaf& leaf) {
        return Covers(leaf, {u, v, leaf.center_W[2]});
      }));
    }
  }
}

TEST(Leaves, AreBoundedAndTheLargestOnesStay) {
  const OctreeBytes tree = TreeOf(RandomSpace(2), UnknownPolicy::kAbsent);
  const LeafCut all = *CutLeaves(tree.bytes, 2, 0.03), some = *CutLeaves(tree.bytes, 2, 0.03, 5);
  ASSERT_GT(all.leaves.size(), 5u);
  EXPECT_EQ(some.leaves.size(), 5u);
  EXPECT_EQ(some.left_out, all.leaves.size() - 5);
  for (size_t i = 5; i < all.leaves.size(); ++i)
    EXPECT_LE(all.leaves[i].size_m, some.leaves.back().size_m);
  const auto json = nlohmann::json::parse(LeavesText(some, {"m", 7}));
  EXPECT_EQ(json["left_out"], all.leaves.size() - 5);
  EXPECT_EQ(json["revision"], 7);
  ASSERT_EQ(json["leaves"].size(), 5u);
  EXPECT_EQ(json["leaves"][0][3], some.leaves[0].size_m);
  EXPECT_EQ(json["leaves"][0][4], some.leaves[0].occupied ? 2 : 1);
}

TEST(Leaves, ABrokenTreeIsRefused) {
  OctreeBytes tree = TreeOf(RandomSpace(1), UnknownPolicy::kAbsent);
  tree.bytes.pop_back();
  EXPECT_FALSE(CutLeaves(tree.bytes, 2, 0));
  EXPECT_FALSE(CutLeaves({}, 2, 0));
}

TEST(Leaves, ArgumentsAreChecked) {
  const auto read = [](const std::string& query) {
    return ReadLeafQuestion(*ParseTarget("/api/leaves?" + query));
  };
  const auto plain = read("axis=x&at=1.5");
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->axis, 0);
  EXPECT_EQ(plain->at_m, 1.5);
  EXPECT_EQ(TreeRequest(*plain).unknown, map_request_t::UNKNOWN_ABSENT);
  const auto inflated = read("at=1&layer=inflated&radius=0.3");
  ASSERT_TRUE(inflated);
  EXPECT_EQ(TreeRequest(*inflated).unknown, map_request_t::UNKNOWN_OCCUPIED);
  EXPECT_EQ(TreeRequest(*inflated).inflate_m, 0.3);
  for (const auto& [query, words] :
       std::map<std::string, std::string>{{"axis=x", "say where"},
                                          {"at=nan", "at"},
                                          {"at=1e9", "at most 100000 m"},
                                          {"at=1&axis=q", "x, y or z"},
                                          {"at=1&layer=all", "raw, closed or inflated"},
                                          {"at=1&layer=inflated", "radius"},
                                          {"at=1&layer=closed&radius=1", "radius"},
                                          {"at=1&layer=inflated&radius=-1", "more than 0"},
                                          {"at=1&other=2", "the arguments are"}}) {
    const auto question = read(query);
    ASSERT_FALSE(question) << query;
    EXPECT_THAT(question.error().message, HasSubstr(words)) << query;
  }
}

}  // namespace
}  // namespace vismap
