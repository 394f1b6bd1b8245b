#include "navigation/without_objects.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "navigation/overlay.h"
#include "navigation/support_planes.h"

// The rule for objects is tested with whole maps: tests/quality/without_objects_test.cc.

namespace vismap {
namespace {

using ::testing::HasSubstr;

/// Samples around a table top at z = 10.5 with a hole, and below it specks of the same thing.
std::vector<SurfaceSample> TableTop() {
  std::vector<SurfaceSample> samples;
  for (int y = -10; y <= 10; ++y) {
    for (int x = -12; x <= 12; ++x) {
      if (std::abs(x) < 4 && std::abs(y) < 4) continue;
      for (const int z : {10, 11}) {
        samples.push_back(
            {Eigen::Vector3i(x, y, z).cast<float>(), static_cast<float>(z) - 10.5F, 2});
      }
    }
  }
  for (int i = 0; i < 50; ++i)
    samples.push_back({Eigen::Vector3i(i % 7, i % 5, i % 9 - 3).cast<float>(), 0, 2});
  return samples;
}

TEST(SupportPlanes, FindsTheTableTopUnderAnObject) {
  const std::vector<SupportPlane> planes = FindSupportPlanes(TableTop());
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_NEAR(planes[0].normal.z(), 1, 1e-3) << "toward free space";
  EXPECT_NEAR(planes[0].HeightOf({0, 0, 12.5}), 2, 0.05);
  EXPECT_TRUE(planes[0].Covers({0, 0, 20}));
  EXPECT_TRUE(planes[0].Covers({11, -9, 3}));
  EXPECT_FALSE(planes[0].Covers({14, 0, 11}));
}

TEST(SupportPlanes, NoneWithoutEnoughSamplesInOne) {
  EXPECT_TRUE(FindSupportPlanes({}).empty());
  std::vector<SurfaceSample> ball;
  for (int i = 0; i < 600; ++i) {
    const float z = 1 - static_cast<float>(i) / 300, a = 2.4F * static_cast<float>(i);
    const float r = std::sqrt(std::max(0.0F, 1 - z * z));
    ball.push_back({20 * Eigen::Vector3f(r * std::cos(a), r * std::sin(a), z), 0, 3});
  }
  EXPECT_TRUE(FindSupportPlanes(ball).empty());
}

TEST(Overlay, ReplacesBlocksOfTheRegionOnly) {
  OccupancyMap map(0.01);
  for (int x = 0; x < 5; ++x) map.Set({x, 0, 0}, BlockOccupancy(CellState::kOccupied));
  const OccupancyDelta overlay{0.01,
                               false,
                               {{{1, 0, 0}, BlockOccupancy(CellState::kFree)},
                                {{3, 0, 0}, BlockOccupancy(CellState::kUnknown)},
                                {{9, 0, 0}, BlockOccupancy(CellState::kFree)}}};
  const auto all = OccupancyWith(map, overlay, std::nullopt);
  ASSERT_TRUE(all);
  EXPECT_EQ(all->size(), 5u);
  EXPECT_TRUE(all->At(BlockIndex{1, 0, 0}).is(CellState::kFree));
  EXPECT_TRUE(all->At(BlockIndex{3, 0, 0}).is(CellState::kUnknown));
  EXPECT_TRUE(map.At(BlockIndex{1, 0, 0}).is(CellState::kOccupied)) << "the map stays";
  const auto part = OccupancyWith(map, overlay, BlockRegion{{0, 0, 0}, {2, 1, 1}});
  EXPECT_EQ(part->size(), 2u);
  EXPECT_TRUE(part->At(BlockIndex{1, 0, 0}).is(CellState::kFree));
  const auto wrong = OccupancyWith(map, {0.02, false, {}}, std::nullopt);
  EXPECT_THAT(wrong.error().message, HasSubstr("voxels of 0.02"));
}

TEST(EditObjects, NothingDiffersWithoutSuchLabels) {
  const SemanticMap map(VoxelGridOptions{0.01, 4.0});
  const ObjectEdit edit{{SegmentLabel{3}}, {{0, 0, 0}}, ObjectAction::kLeaveOut, 0};
  const auto space = EditObjects(map, std::span(&edit, 1), {});
  ASSERT_TRUE(space);
  EXPECT_TRUE(space->delta.blocks.empty());
  EXPECT_EQ(space->delta.voxel_size, 0.01);
}

}  // namespace
}  // namespace vismap
