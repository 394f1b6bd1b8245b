#include "freespace/occupancy_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "base/parallel.h"
#include "freespace/random_occupancy.h"
#include "support/analytic_map.h"
#include "support/occupancy_snapshot.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using testing_support::Random;
using testing_support::RandomBlock;
using testing_support::RandomOccupancy;
using testing_support::SnapshotOf;

SemanticMap MapOfSphere(double radius, int observations = 5) {
  testing_support::AnalyticScene scene;
  scene.distance = [radius](const Eigen::Vector3d& p) {
    return testing_support::SphereDistance(p, {0.01, 0, 0}, radius);
  };
  testing_support::AnalyticRegion region;
  region.min_W.setConstant(-0.3);
  region.max_W.setConstant(0.3);
  region.observations = observations;
  return MakeAnalyticMap(scene, region);
}

TEST(OccupancyMap, DigestTellsContentNotHistory) {
  const OccupancyMap map = RandomOccupancy(1, 80);
  std::vector<BlockIndex> indices = map.SortedIndices();
  OccupancyMap other(map.cell_size());
  std::reverse(indices.begin(), indices.end());
  for (const BlockIndex& index : indices) {
    other.Set(index, BlockOccupancy(CellState::kOccupied));
    other.Set(index, map.At(index));
  }
  EXPECT_EQ(other.Digest(), map.Digest());
  EXPECT_EQ(SnapshotOf(other), SnapshotOf(map));
  other.Set({100, 0, 0}, BlockOccupancy(CellState::kFree));
  EXPECT_NE(other.Digest(), map.Digest());
  other.Set({100, 0, 0}, BlockOccupancy(CellState::kUnknown));
  EXPECT_EQ(other.Digest(), map.Digest());
  EXPECT_NE(OccupancyMap(0.01).Digest(), OccupancyMap(0.02).Digest());
}

TEST(OccupancyMap, DigestSeesPlaceAndState) {
  OccupancyMap a(0.05);
  OccupancyMap b(0.05);
  a.Set({1, 2, 3}, BlockOccupancy(CellState::kFree));
  b.Set({1, 2, 4}, BlockOccupancy(CellState::kFree));
  EXPECT_NE(a.Digest(), b.Digest());
  b = OccupancyMap(0.05);
  b.Set({1, 2, 3}, BlockOccupancy(CellState::kOccupied));
  EXPECT_NE(a.Digest(), b.Digest());
}

TEST(OccupancyMap, SetReportsWhetherSomethingChanged) {
  OccupancyMap map(0.05);
  EXPECT_FALSE(map.Set({0, 0, 0}, BlockOccupancy(CellState::kUnknown)));
  EXPECT_TRUE(map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree)));
  EXPECT_FALSE(map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree)));
  EXPECT_TRUE(map.Set({0, 0, 0}, BlockOccupancy(CellState::kUnknown)));
  EXPECT_EQ(map.size(), 0u);
}

TEST(OccupancyMap, UpdateReturnsOnlyRealChangesAndIncrementalEqualsFull) {
  const SemanticMap before = MapOfSphere(0.10);
  const SemanticMap after = MapOfSphere(0.15);
  OccupancyMap incremental = ClassifyMap(before, {});
  OccupancyMap follower(0.01);
  ASSERT_TRUE(follower.Apply(SnapshotOf(incremental)));
  EXPECT_EQ(follower.Digest(), incremental.Digest());

  std::vector<BlockIndex> changed = after.voxels.SortedIndices();
  const std::vector<BlockIndex> gone = before.voxels.SortedIndices();
  changed.insert(changed.end(), gone.begin(), gone.end());
  const OccupancyDelta delta = incremental.Update(after, changed, {});
  EXPECT_EQ(incremental.Digest(), ClassifyMap(after, {}).Digest());
  EXPECT_GT(delta.blocks.size(), 8u);
  EXPECT_LT(delta.blocks.size(), after.voxels.size()) << "far blocks did not change";
  EXPECT_TRUE(std::is_sorted(delta.blocks.begin(), delta.blocks.end(),
                             [](const auto& a, const auto& b) { return a.first < b.first; }));
  ASSERT_TRUE(follower.Apply(delta));
  EXPECT_EQ(follower.Digest(), incremental.Digest());
  EXPECT_TRUE(incremental.Update(after, changed, {}).blocks.empty());
}

TEST(OccupancyMap, UpdateIsTheSameForAnyNumberOfThreads) {
  const SemanticMap map = MapOfSphere(0.15);
  std::vector<OccupancyDelta> deltas;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    OccupancyMap occupancy(0.01);
    deltas.push_back(occupancy.Update(map, map.voxels.SortedIndices(), {}));
  }
  EXPECT_EQ(deltas[0], deltas[1]);
  EXPECT_EQ(deltas[0], deltas[2]);
}

TEST(OccupancyMap, CompleteDeltaReplacesEverything) {
  OccupancyMap map = RandomOccupancy(3, 50);
  const OccupancyMap other = RandomOccupancy(4, 20, 0.02);
  ASSERT_TRUE(map.Apply(SnapshotOf(other)));
  EXPECT_EQ(map.Digest(), other.Digest());
  EXPECT_EQ(map.cell_size(), 0.02);
}

TEST(OccupancyMap, DeltaOfAnotherVoxelSizeIsRefused) {
  OccupancyMap map = RandomOccupancy(3, 50);
  const std::string before = map.Digest();
  OccupancyDelta delta{0.02, false, {{{0, 0, 0}, BlockOccupancy(CellState::kFree)}}};
  const Result<void> applied = map.Apply(delta);
  ASSERT_FALSE(applied);
  EXPECT_THAT(applied.error().message, HasSubstr("0.02"));
  EXPECT_EQ(map.Digest(), before);
}

TEST(OccupancyMap, KnownCellsIsTheTightBox) {
  OccupancyMap map(0.05);
  EXPECT_FALSE(map.KnownCells());
  OccupancyPlanes planes;
  planes.free[3] = uint64_t{1} << (8 * 2 + 5);
  planes.occupied[6] = uint64_t{1} << (8 * 4 + 1);
  map.Set({-1, 0, 2}, BlockOccupancy(planes));
  EXPECT_EQ(map.KnownCells(), (OccupancyBox{{-7, 2, 19}, {-2, 5, 23}}));
}

TEST(OccupancyMap, PointsFarAwayOrNotANumberAreUnknown) {
  const OccupancyMap map = RandomOccupancy(9, 60);
  EXPECT_EQ(map.At(Eigen::Vector3d(1e12, 0, 0)), CellState::kUnknown);
  EXPECT_EQ(map.At(Eigen::Vector3d(0, std::nan(""), 0)), CellState::kUnknown);
}

}  // namespace
}  // namespace vismap
