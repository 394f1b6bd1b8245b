#include "navigation/distance_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "base/parallel.h"
#include "navigation/naive_distances.h"
#include "navigation/random_leaves.h"

namespace vismap {
namespace {

using testing_support::ChangeLeaves;
using testing_support::NaiveFromCentre;
using testing_support::NaiveFromPoint;
using testing_support::Random;
using testing_support::RandomLeaves;

DistanceField FieldOf(const OccupancyMap& leaves, double limit) {
  DistanceField field = *DistanceField::Make(leaves.cell_size(), {limit});
  field.Update(leaves, leaves.SortedIndices());
  return field;
}

bool Equal(const DistanceField& a, const DistanceField& b) {
  if (a.SortedIndices() != b.SortedIndices()) return false;
  for (const BlockIndex& index : a.SortedIndices()) {
    if (a.At(index) != b.At(index)) return false;
  }
  return true;
}

/// A map with few obstacles in it, so that distances are long.
OccupancyMap SparseLeaves(uint64_t seed, int half) {
  Random random(seed);
  OccupancyMap leaves(0.05);
  for (int z = -half; z < half; ++z) {
    for (int y = -half; y < half; ++y) {
      for (int x = -half; x < half; ++x) {
        OccupancyPlanes planes = BlockOccupancy(CellState::kFree).Planes();
        if (random.Below(20) == 0) planes.occupied[3] = uint64_t{1} << random.Below(64);
        planes.free[3] &= ~planes.occupied[3];
        if (random.Below(60) == 0) planes.free[5] &= ~(uint64_t{1} << random.Below(64));
        leaves.Set({x, y, z}, BlockOccupancy(planes));
      }
    }
  }
  return leaves;
}

void ExpectCentresEqualBruteForce(const OccupancyMap& leaves, double limit, int samples) {
  const DistanceField field = FieldOf(leaves, limit);
  const int most = static_cast<int>(std::pow(2 * limit / leaves.cell_size(), 2) + 1e-6);
  const std::vector<BlockIndex> blocks = field.SortedIndices();
  Random random(5);
  for (int i = 0; i < samples; ++i) {
    const BlockIndex block =
        blocks[static_cast<size_t>(random.Below(static_cast<int>(blocks.size())))];
    const VoxelIndex at{8 * block.x + random.Below(8), 8 * block.y + random.Below(8),
                        8 * block.z + random.Below(8)};
    const auto offset = static_cast<size_t>(OffsetInBlock(at));
    ASSERT_EQ(field.At(block)->obstacle[offset],
              NaiveFromCentre(leaves, at, CellState::kOccupied, most));
    ASSERT_EQ(field.At(block)->unknown[offset],
              NaiveFromCentre(leaves, at, CellState::kUnknown, most));
  }
}

TEST(DistanceField, CentresEqualBruteForce) {
  for (const double limit : {0.04, 0.3, 0.77}) {
    ExpectCentresEqualBruteForce(RandomLeaves(1, 3), limit, 1000);
    ExpectCentresEqualBruteForce(SparseLeaves(2, 3), limit, 1000);
  }
  ExpectCentresEqualBruteForce(SparseLeaves(3, 6), 2.0, 300);
  ExpectCentresEqualBruteForce(SparseLeaves(4, 6), 0.05 * kMostDistanceLeaves, 60);
}

void ExpectPointsEqualBruteForce(const OccupancyMap& leaves, double limit, int samples) {
  const DistanceField field = FieldOf(leaves, limit);
  Random random(6);
  const auto coordinate = [&] { return (random.Below(20001) - 10000) * 1.4e-4; };
  int within = 0;
  for (int i = 0; i < samples; ++i) {
    Eigen::Vector3d p(coordinate(), coordinate(), coordinate());
    if (i % 5 == 0) p = (p / 0.05).array().round() * 0.05;  // on the faces of leaves
    if (!field.At(BlockOf(VoxelIndex{static_cast<int>(std::floor(p.x() / 0.05)),
                                     static_cast<int>(std::floor(p.y() / 0.05)),
                                     static_cast<int>(std::floor(p.z() / 0.05))})))
      continue;
    const double obstacle = NaiveFromPoint(leaves, p, CellState::kOccupied, limit);
    const double unknown = NaiveFromPoint(leaves, p, CellState::kUnknown, limit);
    ASSERT_NEAR(field.FromObstacle(p).distance_m, obstacle, 1e-9) << p.transpose();
    ASSERT_NEAR(field.FromUnknown(p).distance_m, unknown, 1e-9) << p.transpose();
    const Clearance nearest = field.From(p);
    ASSERT_NEAR(nearest.distance_m, std::min(obstacle, unknown), 1e-9);
    if (std::min(obstacle, unknown) < limit - 1e-9) {
      ++within;
      if (std::abs(obstacle - unknown) > 1e-9) {
        ASSERT_EQ(nearest.nearest,
                  obstacle < unknown ? NearestThing::kObstacle : NearestThing::kUnknown);
      }
    }
  }
  EXPECT_GT(within, samples / 10);
}

TEST(DistanceField, PointsEqualBruteForceOverBoxes) {
  ExpectPointsEqualBruteForce(RandomLeaves(11, 3), 0.3, 2000);
  ExpectPointsEqualBruteForce(SparseLeaves(12, 4), 0.6, 700);
  ExpectPointsEqualBruteForce(SparseLeaves(13, 4), 0.93, 300);
}

TEST(DistanceField, GradientLeadsAwayAndHasLengthOne) {
  const OccupancyMap leaves = SparseLeaves(21, 4);
  const DistanceField field = FieldOf(leaves, 1.0);
  Random random(8);
  const auto coordinate = [&] { return (random.Below(20001) - 10000) * 1.4e-4; };
  int checked = 0;
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector3d p(coordinate(), coordinate(), coordinate());
    const Clearance clearance = field.FromObstacle(p);
    if (clearance.distance_m == 0 || clearance.nearest == NearestThing::kNone) {
      EXPECT_EQ(clearance.away_W.norm(), 0);
      continue;
    }
    ASSERT_NEAR(clearance.away_W.norm(), 1, 1e-9);
    // The nearest point, and a step back to it.
    const Eigen::Vector3d obstacle = p - clearance.distance_m * clearance.away_W;
    ASSERT_NEAR(NaiveFromPoint(leaves, obstacle, CellState::kOccupied, 0.1), 0, 1e-9);
    const Eigen::Vector3d nearer = p - 1e-4 * clearance.away_W;
    if (clearance.distance_m > 1e-3) {
      ASSERT_NEAR(field.FromObstacle(nearer).distance_m, clearance.distance_m - 1e-4, 1e-9);
    }
    ++checked;
  }
  EXPECT_GT(checked, 500);
}

TEST(DistanceField, OutsideOfTheMapIsUnknown) {
  const DistanceField field = FieldOf(SparseLeaves(31, 2), 1.0);
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(5, 0, 0), Eigen::Vector3d(0, -1e30, 0), Eigen::Vector3d(std::nan(""), 0, 0),
        Eigen::Vector3d(0, 0, std::numeric_limits<double>::infinity())}) {
    EXPECT_EQ(field.From(p).distance_m, 0);
    EXPECT_EQ(field.From(p).nearest, NearestThing::kUnknown);
    EXPECT_EQ(field.FromObstacle(p).distance_m, 0);
  }
  EXPECT_EQ(DistanceField::Make(0.05, {1.0})->From({0, 0, 0}).nearest, NearestThing::kUnknown);
}

TEST(DistanceField, IncrementalEqualsFullAndReportsChanges) {
  for (const double limit : {0.3, 0.9, 2.0}) {
    OccupancyMap leaves(0.05);
    DistanceField field = *DistanceField::Make(0.05, {limit});
    std::map<BlockIndex, std::optional<BlockDistances>> follower;
    Random random(7);
    for (int round = 0; round < 120; ++round) {
      const std::vector<BlockIndex> changed = ChangeLeaves(&random, 3, &leaves);
      for (const BlockIndex& index : field.Update(leaves, changed))
        follower[index] = field.At(index);
      const DistanceField full = FieldOf(leaves, limit);
      ASSERT_TRUE(Equal(field, full)) << "limit " << limit << " round " << round;
      for (const BlockIndex& index : full.SortedIndices())
        ASSERT_EQ(follower[index], full.At(index)) << "limit " << limit << " round " << round;
    }
    EXPECT_TRUE(field.Update(leaves, leaves.SortedIndices()).empty());
  }
}

TEST(DistanceField, EmptiedMapLeavesNothing) {
  OccupancyMap leaves = RandomLeaves(41, 3);
  DistanceField field = FieldOf(leaves, 1.0);
  const std::vector<BlockIndex> all = leaves.SortedIndices();
  EXPECT_GT(field.bytes(), 100000u);
  field.Update(OccupancyMap(0.05), all);
  EXPECT_TRUE(field.SortedIndices().empty());
  EXPECT_LT(field.bytes(), 20000u);
}

TEST(DistanceField, EqualForAnyNumberOfThreads) {
  const OccupancyMap leaves = RandomLeaves(9, 4);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return FieldOf(leaves, 1.0);
  };
  const DistanceField one = with(1);
  EXPECT_TRUE(Equal(one, with(2)));
  EXPECT_TRUE(Equal(one, with(4)));
}

TEST(DistanceField, TakesTenBytesPerLeaf) {
  const OccupancyMap leaves = SparseLeaves(51, 6);
  const DistanceField field = FieldOf(leaves, 2.0);
  const double per_leaf =
      static_cast<double>(field.bytes()) / (static_cast<double>(leaves.size()) * 512);
  EXPECT_LT(per_leaf, 13);
}

TEST(DistanceField, RefusesALimitOutOfRange) {
  for (const double limit : {0.0, -1.0, 4.5, std::nan("")}) {
    const Result<DistanceField> field = DistanceField::Make(0.05, {limit});
    ASSERT_FALSE(field) << limit;
    EXPECT_NE(field.error().message.find("at most 4.45 m"), std::string::npos)
        << field.error().message;
  }
  EXPECT_TRUE(DistanceField::Make(0.05, {4.45}));
}

}  // namespace
}  // namespace vismap
