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

/// Appends the nodes of an octree whose smallest leaves at z = 0 fill a square of 2^`levels` of
/// them along each side. Returns the number of nodes below this one, which is `depth` below the
/// root.
int64_t AddSquare(int depth, int levels, std::vector<uint8_t>* data) {
  const int first = depth == 0 ? 4 : 0;
  const int children = depth >= 16 - levels ? 4 : 1;
  const uint32_t kind = depth == 15 ? 2 : 3;
  uint32_t code = 0;
  for (int child = first; child < first + children; ++child) code |= kind << (2 * child);
  data->push_back(static_cast<uint8_t>(code));
  data->push_back(static_cast<uint8_t>(code >> 8));
  int64_t nodes = children;
  for (int child = 0; depth < 15 && child < children; ++child)
    nodes += AddSquare(depth + 1, levels, data);
  return nodes;
}

std::vector<uint8_t> SquareTree(int levels) {
  std::vector<uint8_t> data;
  const std::string header = "# Octomap OcTree binary file\nid OcTree\nsize " +
                             std::to_string(AddSquare(0, levels, &data) + 1) + "\nres 0.1\ndata\n";
  data.insert(data.begin(), header.begin(), header.end());
  return data;
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
  for (size_t i = 1; i < all.leaves.size(); ++i)
    EXPECT_LE(all.leaves[i].size_m, all.leaves[i - 1].size_m);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(some.leaves[i].center_W, all.leaves[i].center_W);
  const auto json = nlohmann::json::parse(LeavesText(some, {"m", 7}));
  EXPECT_EQ(json["left_out"], all.leaves.size() - 5);
  EXPECT_EQ(json["revision"], 7);
  ASSERT_EQ(json["leaves"].size(), 5u);
  EXPECT_EQ(json["leaves"][0][3], some.leaves[0].size_m);
  EXPECT_EQ(json["leaves"][0][4], some.leaves[0].occupied ? 2 : 1);
}

TEST(Leaves, AHugeCutTakesNoMoreMemoryThanWhatIsKept) {
  const LeafCut cut = *CutLeaves(SquareTree(10), 2, 0.05);
  EXPECT_EQ(cut.leaves.size(), kMostCutLeaves);
  EXPECT_EQ(cut.left_out, (size_t{1} << 20) - kMostCutLeaves);
  EXPECT_LE(cut.leaves.capacity(), 2 * kMostCutLeaves);
}

LeafQuestion Raw(double at_m) {
  LeafQuestion question;
  question.at_m = at_m;
  return question;
}

TEST(LeafAnswers, ATreeIsKeptForItsQuestionAndItsMap) {
  LeafAnswers answers;
  LeafQuestion closed = Raw(0.03);
  closed.closed = true;
  EXPECT_FALSE(answers.Keeps(Raw(0.03), {"m", 7}, 100));
  const OctreeBytes tree = TreeOf(RandomSpace(2), UnknownPolicy::kAbsent);
  const HttpAnswer answer = answers.Take(Raw(0.03), {"m", 7}, tree.bytes, 100);
  ASSERT_EQ(answer.status, 200);
  EXPECT_EQ(answer.body, answers.Cut(Raw(0.03), 100).body);
  const auto json = nlohmann::json::parse(answer.body.begin(), answer.body.end());
  EXPECT_EQ(json["leaves"].size(), CutLeaves(tree.bytes, 2, 0.03)->leaves.size());
  EXPECT_EQ(json["revision"], 7);
  EXPECT_TRUE(answers.Keeps(Raw(0.5), {"m", 7}, 200));
  EXPECT_TRUE(answers.Keeps(Raw(0.5), {"m", 8}, 101.9));
  EXPECT_FALSE(answers.Keeps(Raw(0.5), {"m", 8}, 102.1));
  EXPECT_FALSE(answers.Keeps(Raw(0.5), {"other", 7}, 100));
  EXPECT_FALSE(answers.Keeps(closed, {"m", 7}, 100));
}

TEST(LeafAnswers, ABrokenTreeIsNotKept) {
  LeafAnswers answers;
  OctreeBytes tree = TreeOf(RandomSpace(1), UnknownPolicy::kAbsent);
  tree.bytes.pop_back();
  EXPECT_EQ(answers.Take(Raw(0), {"m", 7}, tree.bytes, 100).status, 504);
  EXPECT_FALSE(answers.Keeps(Raw(0), {"m", 7}, 100));
}

TEST(LeafAnswers, CutsAreAtMostTenPerSecond) {
  LeafAnswers answers;
  const OctreeBytes tree = TreeOf(RandomSpace(2), UnknownPolicy::kAbsent);
  ASSERT_EQ(answers.Take(Raw(0), {"m", 7}, tree.bytes, 100).status, 200);  // a check and a cut
  for (int i = 0; i < 8; ++i) EXPECT_EQ(answers.Cut(Raw(0.1 * i), 100).status, 200);
  EXPECT_EQ(answers.Cut(Raw(0), 100).status, 429);
  EXPECT_EQ(answers.Cut(Raw(0), 100.11).status, 200);
  EXPECT_EQ(answers.Cut(Raw(0), 100.11).status, 429);
}

TEST(LeafAnswers, ALargeTreeCostsMoreAndIsCheckedOnce) {
  LeafAnswers answers;
  const std::vector<uint8_t> tree = SquareTree(12);
  const double cost = static_cast<double>(tree.size()) / LeafAnswers::kBytesPerToken;
  ASSERT_GT(cost, 2);
  double now = 100;
  ASSERT_EQ(answers.Take(Raw(0), {"m", 7}, tree, now).status, 200);
  // Another page had the same question at the same time: only the cut is to pay.
  now += 2 * cost / LeafAnswers::kMostPerSecond;
  EXPECT_TRUE(answers.MayCut(now));
  ASSERT_EQ(answers.Take(Raw(0), {"m", 7}, tree, now).status, 200);
  int cuts = 0;
  while (answers.Cut(Raw(0), now).status == 200) ++cuts;
  EXPECT_EQ(cuts, static_cast<int>(std::ceil((LeafAnswers::kMostPerSecond - 1) / cost)) - 1);
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
