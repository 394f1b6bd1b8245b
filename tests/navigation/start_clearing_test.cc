#include "navigation/start_clearing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "navigation/inflate.h"
#include "navigation/random_leaves.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::Random;
using testing_support::RandomLeaves;

/// The map with the leaves that a body covers.
OccupancyMap Cleared(OccupancyMap leaves, const RobotBody& body,
                     const std::vector<Eigen::Vector3d>& path) {
  const Result<LeafSets> sets = CoveredUnknownLeaves(leaves, body, path);
  EXPECT_TRUE(sets) << sets.error().message;
  for (const auto& [index, bits] : *sets) leaves.Set(index, WithFreeLeaves(leaves.At(index), bits));
  return leaves;
}

/// Free leaves around an unknown hole of 1 m at the origin.
OccupancyMap WithHole() {
  OccupancyMap leaves(0.05);
  for (int z = -4; z < 4; ++z) {
    for (int y = -4; y < 4; ++y) {
      for (int x = -4; x < 4; ++x) {
        const auto inner = [](int i) { return i >= -1 && i < 1; };
        if (!inner(x) || !inner(y) || !inner(z))
          leaves.Set({x, y, z}, BlockOccupancy(CellState::kFree));
      }
    }
  }
  return leaves;
}

TEST(StartClearing, RobotMayStartWhereItStands) {
  const Eigen::Vector3d pose(0.07, -0.12, 0.11);
  for (const RobotBody body : {RobotBody{0.2, 0, 0}, RobotBody{0.2, 0.3, 0.4}}) {
    OccupancyMap leaves = Cleared(WithHole(), body, {pose});
    const auto inflated = Inflate(leaves, {0.2, UnknownPolicy::kOccupied});
    EXPECT_EQ(inflated->At(pose), CellState::kFree);
    EXPECT_EQ(leaves.At(Eigen::Vector3d(pose + Eigen::Vector3d(0.3, 0, 0))), CellState::kUnknown);
  }
  EXPECT_EQ(Inflate(WithHole(), {0.2, UnknownPolicy::kOccupied})->At(pose), CellState::kUnknown);
}

TEST(StartClearing, CylinderReachesAsFarAsItSays) {
  const OccupancyMap leaves = Cleared(WithHole(), {0.1, 0.15, 0.3}, {{0.025, 0.025, 0.025}});
  const auto at = [&](int x, int z) { return leaves.At(VoxelIndex{x, 0, z}); };
  EXPECT_EQ(at(2, 0), CellState::kFree);
  EXPECT_EQ(at(3, 0), CellState::kUnknown);
  EXPECT_EQ(at(0, 6), CellState::kFree);
  EXPECT_EQ(at(0, 7), CellState::kUnknown);
  EXPECT_EQ(at(0, -3), CellState::kFree);
  EXPECT_EQ(at(0, -4), CellState::kUnknown);
}

TEST(StartClearing, SweepsFromPoseToPose) {
  const OccupancyMap leaves = Cleared(WithHole(), {0.1, 0, 0}, {{-0.3, 0, 0}, {0.3, 0.02, 0}});
  for (double x = -0.35; x <= 0.35; x += 0.05)
    EXPECT_EQ(leaves.At(Eigen::Vector3d(x, 0.01, 0.01)), CellState::kFree) << x;
  EXPECT_EQ(leaves.At(Eigen::Vector3d(0.3, 0.3, 0)), CellState::kUnknown);
}

TEST(StartClearing, ChangesUnknownLeavesWithinReachOnly) {
  const OccupancyMap leaves = RandomLeaves(5, 3);
  Random random(6);
  int assumed = 0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d pose(random.Below(200) * 0.01 - 1, random.Below(200) * 0.01 - 1, 0.02);
    const Result<LeafSets> sets =
        CoveredUnknownLeaves(leaves, {0.2, 0, 0}, std::vector<Eigen::Vector3d>{pose});
    for (const auto& [index, bits] : *sets) {
      for (int offset = 0; offset < kBlockVoxels; ++offset) {
        if (((bits[static_cast<size_t>(offset / 64)] >> (offset % 64)) & 1) == 0) continue;
        ++assumed;
        ASSERT_EQ(leaves.At(index).At(offset), CellState::kUnknown);
        const Eigen::Vector3d centre = 0.05 * Eigen::Vector3d(8 * index.x + offset % 8 + 0.5,
                                                              8 * index.y + offset / 8 % 8 + 0.5,
                                                              8 * index.z + offset / 64 + 0.5);
        ASSERT_LT((centre - pose).norm(), 0.2 + 2 * 0.05 * std::sqrt(3.0));
      }
    }
  }
  EXPECT_GT(assumed, 100);
}

TEST(StartClearing, RefusesWhatIsNoBodyAndNoPath) {
  const OccupancyMap leaves(0.05);
  const auto message = [&](const RobotBody& body, const Eigen::Vector3d& p) {
    const auto sets = CoveredUnknownLeaves(leaves, body, std::vector<Eigen::Vector3d>{p});
    return sets ? std::string("none") : sets.error().message;
  };
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_THAT(message({0, 0, 0}, {0, 0, 0}), HasSubstr("radius of more than 0"));
  EXPECT_THAT(message({infinite, 0, 0}, {0, 0, 0}), HasSubstr("at most 5 m"));
  EXPECT_THAT(message({0.2, -1, 0}, {0, 0, 0}), HasSubstr("below and above"));
  EXPECT_THAT(message({0.2, 0, 0}, {std::nan(""), 0, 0}), HasSubstr("finite positions"));
  EXPECT_THAT(message({0.2, 0, 0}, {0, 1e9, 0}), HasSubstr("within 50000 m"));
  EXPECT_EQ(message({0.2, 0, 0}, {0, 0, 0}), "none");
}

}  // namespace
}  // namespace vismap
