#include "navigation/inflate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "base/parallel.h"
#include "navigation/random_leaves.h"

namespace vismap {
namespace {

using testing_support::ChangeLeaves;
using testing_support::Random;
using testing_support::RandomLeaves;

bool IsObstacle(CellState state, UnknownPolicy unknown) {
  return state == CellState::kOccupied ||
         (unknown == UnknownPolicy::kOccupied && state == CellState::kUnknown);
}

/// Whether an obstacle has a gap of less than the radius to a leaf, leaf by leaf in metres.
bool NearObstacle(const OccupancyMap& leaves, VoxelIndex at, const InflateOptions& options) {
  const double leaf = leaves.cell_size();
  const int reach = static_cast<int>(std::ceil(options.radius_m / leaf)) + 1;
  const auto gap = [&](int d) { return std::max(0, std::abs(d) - 1) * leaf; };
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        if (!IsObstacle(leaves.At(VoxelIndex{at.x + x, at.y + y, at.z + z}), options.unknown))
          continue;
        const double distance = std::sqrt(gap(x) * gap(x) + gap(y) * gap(y) + gap(z) * gap(z));
        if (distance < options.radius_m - 1e-9) return true;
      }
    }
  }
  return false;
}

CellState NaiveInflated(const OccupancyMap& leaves, VoxelIndex at, const InflateOptions& options) {
  const CellState state = leaves.At(at);
  if (state == CellState::kOccupied) return state;
  if (state == CellState::kUnknown && options.unknown == UnknownPolicy::kOccupied) return state;
  return NearObstacle(leaves, at, options) ? CellState::kOccupied : state;
}

OccupancyMap Inflated(const OccupancyMap& leaves, const InflateOptions& options) {
  Result<OccupancyMap> inflated = Inflate(leaves, options);
  EXPECT_TRUE(inflated) << inflated.error().message;
  return std::move(*inflated);
}

void ExpectEqualsNaive(const OccupancyMap& leaves, const InflateOptions& options, uint64_t seed) {
  const OccupancyMap inflated = Inflated(leaves, options);
  Random random(seed);
  std::array<int, 3> seen{};
  for (int i = 0; i < 3000; ++i) {
    const VoxelIndex at{random.Below(64) - 32, random.Below(64) - 32, random.Below(56) - 28};
    const CellState expected = NaiveInflated(leaves, at, options);
    ASSERT_EQ(inflated.At(at), expected)
        << "radius " << options.radius_m << " at " << at.x << " " << at.y << " " << at.z;
    ++seen[static_cast<size_t>(expected)];
  }
  EXPECT_GT(seen[static_cast<size_t>(CellState::kOccupied)], 0);
}

TEST(Inflate, EqualsBruteForce) {
  const OccupancyMap leaves = RandomLeaves(1, 3);
  for (const UnknownPolicy unknown : {UnknownPolicy::kOccupied, UnknownPolicy::kAbsent}) {
    for (const double radius : {0.0, 0.01, 0.05, 0.1, 0.12, 0.2, 0.21, 0.45})
      ExpectEqualsNaive(leaves, {radius, unknown}, 2);
  }
}

/// Free leaves in [-half, half) blocks along each axis, with one obstacle at the origin.
OccupancyMap OneObstacle(int half) {
  OccupancyMap leaves(0.05);
  for (int z = -half; z < half; ++z) {
    for (int y = -half; y < half; ++y) {
      for (int x = -half; x < half; ++x) leaves.Set({x, y, z}, BlockOccupancy(CellState::kFree));
    }
  }
  OccupancyPlanes planes = BlockOccupancy(CellState::kFree).Planes();
  planes.free[0] &= ~uint64_t{1};
  planes.occupied[0] |= 1;
  leaves.Set({0, 0, 0}, BlockOccupancy(planes));
  return leaves;
}

TEST(Inflate, LargestRadiusReachesAsFarAsItSays) {
  const OccupancyMap leaves = OneObstacle(6);
  const OccupancyMap inflated =
      Inflated(leaves, {0.05 * kMostInflatedLeaves, UnknownPolicy::kAbsent});
  for (const auto& [x, y, z] : std::vector<std::array<int, 3>>{{28, 0, 0},
                                                               {29, 0, 0},
                                                               {0, -28, 0},
                                                               {0, -29, 0},
                                                               {0, 0, 28},
                                                               {0, 0, 29},
                                                               {20, 20, 5},
                                                               {20, 20, 10},
                                                               {-17, 17, 15},
                                                               {-17, 17, 18},
                                                               {16, -17, -17},
                                                               {18, -17, -17}}) {
    const auto gap2 = [](int d) { return std::pow(std::max(0, std::abs(d) - 1), 2); };
    const bool near = gap2(x) + gap2(y) + gap2(z) < 28 * 28;
    EXPECT_EQ(inflated.At(VoxelIndex{x, y, z}), near ? CellState::kOccupied : CellState::kFree)
        << x << " " << y << " " << z;
  }
}

TEST(Inflate, OutsideOfTheMapIsAnObstacleOfAClosedMap) {
  const OccupancyMap inflated = Inflated(OneObstacle(3), {0.2, UnknownPolicy::kOccupied});
  EXPECT_EQ(inflated.At(VoxelIndex{23, 12, 12}), CellState::kOccupied);
  EXPECT_EQ(inflated.At(VoxelIndex{20, 12, 12}), CellState::kOccupied);
  EXPECT_EQ(inflated.At(VoxelIndex{19, 12, 12}), CellState::kFree);
  EXPECT_EQ(inflated.At(VoxelIndex{24, 12, 12}), CellState::kUnknown);
}

TEST(Inflate, IncrementalEqualsFull) {
  for (const InflateOptions options : {InflateOptions{0.2, UnknownPolicy::kOccupied},
                                       InflateOptions{0.5, UnknownPolicy::kOccupied},
                                       InflateOptions{0.3, UnknownPolicy::kAbsent}}) {
    OccupancyMap leaves(0.05);
    Inflater inflater = *Inflater::Make(leaves.cell_size(), options);
    OccupancyMap follower(leaves.cell_size());
    Random random(7);
    for (int round = 0; round < 150; ++round) {
      const std::vector<BlockIndex> changed = ChangeLeaves(&random, 3, &leaves);
      const OccupancyDelta delta = inflater.Update(leaves, changed);
      ASSERT_TRUE(follower.Apply(delta));
      ASSERT_EQ(inflater.inflated().Digest(), Inflated(leaves, options).Digest()) << round;
      ASSERT_EQ(follower.Digest(), inflater.inflated().Digest());
    }
    EXPECT_TRUE(inflater.Update(leaves, leaves.SortedIndices()).blocks.empty());
  }
}

TEST(Inflate, EqualForAnyNumberOfThreads) {
  const OccupancyMap leaves = RandomLeaves(9, 4);
  std::set<std::string> digests;
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    digests.insert(Inflated(leaves, {0.2, UnknownPolicy::kOccupied}).Digest());
  }
  EXPECT_EQ(digests.size(), 1u);
}

TEST(Inflate, RefusesARadiusOutOfRange) {
  for (const double radius : {-0.1, 1.45, std::nan(""), std::numeric_limits<double>::infinity()}) {
    const Result<Inflater> inflater = Inflater::Make(0.05, {radius, UnknownPolicy::kOccupied});
    ASSERT_FALSE(inflater) << radius;
    EXPECT_NE(inflater.error().message.find("expected 0 to 1.4"), std::string::npos)
        << inflater.error().message;
  }
  EXPECT_TRUE(Inflater::Make(0.05, {1.4, UnknownPolicy::kOccupied}));
}

}  // namespace
}  // namespace vismap
