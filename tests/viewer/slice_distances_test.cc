#include "viewer/slice_distances.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "navigation/distance_field.h"

namespace vismap {
namespace {

constexpr double kLeaf = 0.1;

/// Free leaves but for an occupied plate at x = 3 in block (0, 0, 0), and unknown beyond the
/// blocks.
OccupancyMap Plate() {
  OccupancyMap leaves(kLeaf);
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) leaves.Set({x, y, z}, BlockOccupancy(CellState::kFree));
    }
  }
  OccupancyPlanes planes;
  for (size_t z = 0; z < 8; ++z) {
    planes.occupied[z] = 0x0101010101010101u << 3;
    planes.free[z] = ~planes.occupied[z];
  }
  leaves.Set({0, 0, 0}, BlockOccupancy(planes));
  return leaves;
}

DistanceUpdate UpdateOf(const OccupancyMap& leaves, double limit) {
  DistanceField field = *DistanceField::Make(kLeaf, {limit});
  field.Update(leaves, leaves.SortedIndices());
  DistanceUpdate update;
  update.leaf_m = kLeaf;
  update.limit_m = limit;
  for (const BlockIndex& index : field.SortedIndices())
    update.blocks.emplace_back(index, field.At(index));
  return update;
}

Slice Cut(const OccupancyMap& leaves, const SliceQuestion& question) {
  return *CutSlice(leaves, question);
}

size_t CellAt(const Slice& slice, double u, double v) {
  const auto column = static_cast<int>(std::floor((u - slice.origin_m[0]) / slice.cell_m));
  const auto row = static_cast<int>(std::floor((v - slice.origin_m[1]) / slice.cell_m));
  return static_cast<size_t>(row * slice.width + column);
}

TEST(SliceDistances, AtCentresOfLeavesTheyAreThoseOfTheField) {
  const OccupancyMap leaves = Plate();
  DistanceField field = *DistanceField::Make(kLeaf, {0.6});
  field.Update(leaves, leaves.SortedIndices());
  for (int axis = 0; axis < 3; ++axis) {
    const SliceQuestion question{axis, 0.45, 0};
    const Slice slice = Cut(leaves, question);
    const SliceDistances distances = DistancesOf(slice, question, UpdateOf(leaves, 0.6));
    ASSERT_EQ(distances.metres.size(), slice.states.size());
    size_t near = 0;
    for (int row = 0; row < slice.height; ++row) {
      for (int column = 0; column < slice.width; ++column) {
        Eigen::Vector3d p_W;
        p_W[axis] = 0.45;
        p_W[axis == 0 ? 1 : 0] = slice.origin_m[0] + (column + 0.5) * kLeaf;
        p_W[axis == 2 ? 1 : 2] = slice.origin_m[1] + (row + 0.5) * kLeaf;
        const float found = distances.metres[static_cast<size_t>(row * slice.width + column)];
        EXPECT_NEAR(found, field.FromObstacle(p_W).distance_m, 1e-5) << p_W.transpose();
        near += found < 0.6F ? 1 : 0;
      }
    }
    EXPECT_GT(near, 50u);
  }
}

TEST(SliceDistances, BetweenCentresTheyAreLinearAndNothingIsKnownInUnknownLeaves) {
  const OccupancyMap leaves = Plate();
  // Cells of a fifth of a leaf, as a slice of voxels has.
  Slice slice;
  slice.cell_m = kLeaf / 5;
  slice.origin_m[0] = -1.0;
  slice.origin_m[1] = 0.44;
  slice.width = 100;
  slice.height = 1;
  slice.states.resize(100);
  const SliceQuestion question{2, 0.45, 0};
  const SliceDistances distances = DistancesOf(slice, question, UpdateOf(leaves, 2));
  for (size_t i = 0; i < slice.states.size(); ++i) {
    const double x = -1.0 + (static_cast<double>(i) + 0.5) * slice.cell_m;
    const float found = distances.metres[i];
    if (x < -0.8) {
      EXPECT_TRUE(std::isnan(found)) << x;
    } else if (x > 0.4 + kLeaf / 2 && x < 0.75) {
      EXPECT_NEAR(found, x - 0.4, 1e-5);
    } else if (x > 0.32 && x < 0.38) {
      EXPECT_LE(found, kLeaf / 2);
    }
  }
  EXPECT_NEAR(distances.metres[CellAt(slice, 0.35, 0.45)], 0, 1e-6)
      << "the centre of an occupied leaf";
}

TEST(SliceDistances, AreBehindTheStatesOfASlice) {
  const OccupancyMap leaves = Plate();
  const SliceQuestion question{2, 0.45, 0};
  Slice slice = Cut(leaves, question);
  const SliceDistances distances = DistancesOf(slice, question, UpdateOf(leaves, 0.6));
  const auto bytes = EncodeSlice(slice, question, {"m", 3}, &distances);
  uint32_t size = 0;
  std::memcpy(&size, bytes.data(), 4);
  const auto json = nlohmann::json::parse(bytes.begin() + 4, bytes.begin() + 4 + size);
  EXPECT_EQ(json["distances"], true);
  EXPECT_EQ(json["distance_leaf_m"], kLeaf);
  EXPECT_EQ(json["distance_limit_m"], 0.6);
  EXPECT_FALSE(json.contains("distances_problem"));
  const size_t begin = (4 + size + slice.states.size() + 3) / 4 * 4;
  ASSERT_EQ(bytes.size(), begin + 4 * slice.states.size());
  float first = 0;
  std::memcpy(&first, bytes.data() + begin, 4);
  EXPECT_EQ(first, distances.metres[0]);
  const auto without = EncodeSlice(slice, question, {"m", 3}, nullptr, "there is none");
  std::memcpy(&size, without.data(), 4);
  const auto problem = nlohmann::json::parse(without.begin() + 4, without.begin() + 4 + size);
  EXPECT_EQ(problem["distances"], false);
  EXPECT_EQ(problem["distances_problem"], "there is none");
  EXPECT_EQ(without.size(), 4 + size + slice.states.size());
}

TEST(SliceDistances, TheRequestIsForTheBoxAroundTheSlice) {
  const SliceQuestion question{1, 0.45, 0};
  const Slice slice = Cut(Plate(), question);
  const map_request_t request = DistanceRequest(slice, question);
  EXPECT_EQ(request.verb, "distances");
  EXPECT_TRUE(request.has_bbx);
  EXPECT_NEAR(request.bbx_min_W[1], 0.45, 1e-3);
  EXPECT_GT(request.bbx_max_W[1], request.bbx_min_W[1]);
  EXPECT_LT(request.bbx_min_W[0], -0.8);
  EXPECT_GT(request.bbx_max_W[2], 0.8);
}

}  // namespace
}  // namespace vismap
