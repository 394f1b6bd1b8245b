#include "freespace/occupancy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "freespace/occupancy_map.h"
#include "support/analytic_map.h"
#include "support/voxel_reading.h"

namespace vismap {
namespace {

using testing_support::ReadVoxel;
using testing_support::VoxelCenter;

constexpr VoxelGridOptions kGrid{0.01, 4.0};

/// The state that the rule gives a voxel at this distance from the surface [voxels].
CellState StateAt(double voxels, int observations, const OccupancyOptions& options = {},
                  const VoxelGridOptions& grid = kGrid) {
  Block block;
  block.surface = std::make_unique<SurfaceVoxels>();
  constexpr int kOffset = 77;
  const double clamped = std::clamp(voxels / grid.truncation_voxels, -1.0, 1.0);
  block.surface->distance[kOffset] = static_cast<int16_t>(std::lround(clamped * kTruncationSteps));
  block.surface->weight[kOffset] = observations > 0 ? 100 : 0;
  block.surface->observations[kOffset] = static_cast<uint8_t>(observations);
  const BlockOccupancy occupancy = ClassifyBlock(block, grid, options);
  for (int i = 0; i < kBlockVoxels; ++i) {
    if (i == kOffset) continue;
    EXPECT_EQ(occupancy.At(i), CellState::kUnknown);
  }
  return occupancy.At(kOffset);
}

TEST(ClassifyBlock, SurfaceVoxelsFollowTheRule) {
  EXPECT_EQ(StateAt(-4.0, 2), CellState::kOccupied);
  EXPECT_EQ(StateAt(0.0, 2), CellState::kOccupied);
  EXPECT_EQ(StateAt(0.99, 2), CellState::kOccupied);
  EXPECT_EQ(StateAt(1.01, 2), CellState::kUnknown);
  EXPECT_EQ(StateAt(1.99, 2), CellState::kUnknown);
  EXPECT_EQ(StateAt(2.01, 2), CellState::kFree);
  EXPECT_EQ(StateAt(4.0, 2), CellState::kFree);
}

TEST(ClassifyBlock, VoxelsThatThinThingsHitAreOccupiedInBlocksOfEveryKind) {
  for (const int kind : {0, 1, 2}) {
    Block block;
    if (kind == 0) block.all_free = true;
    if (kind == 1) {
      block.free = std::make_unique<FreeVoxels>();
      block.free->twice.fill(~uint64_t{0});
    }
    if (kind == 2) {
      block.surface = std::make_unique<SurfaceVoxels>();
      block.surface->distance.fill(kTruncationSteps);
      block.surface->weight.fill(100);
      block.surface->observations.fill(9);
    }
    block.thin = std::make_unique<ThinVoxels>();
    block.thin->hits[70] = 3;
    block.thin->hits[71] = 2;
    const BlockOccupancy occupancy = ClassifyBlock(block, kGrid, {});
    for (int i = 0; i < kBlockVoxels; ++i)
      EXPECT_EQ(occupancy.At(i), i == 70 ? CellState::kOccupied : CellState::kFree) << kind;
    OccupancyOptions off;
    off.thin_hits = 0;
    EXPECT_TRUE(ClassifyBlock(block, kGrid, off).is(CellState::kFree));
  }
}

TEST(ClassifyBlock, TooFewObservationsAreUnknown) {
  for (const double voxels : {-3.0, 0.0, 1.5, 4.0}) {
    EXPECT_EQ(StateAt(voxels, 0), CellState::kUnknown);
    EXPECT_EQ(StateAt(voxels, 1), CellState::kUnknown);
  }
  OccupancyOptions options;
  options.min_observations = 1;
  EXPECT_EQ(StateAt(4.0, 1, options), CellState::kFree);
  options.min_observations = 0;
  EXPECT_EQ(StateAt(4.0, 0, options), CellState::kUnknown) << "never seen, whatever the options";
}

TEST(ClassifyBlock, DistanceAtTruncationIsFreeEvenIfFreeStartsBeyondIt) {
  OccupancyOptions options;
  options.free_min_voxels = 5;
  EXPECT_EQ(StateAt(4.0, 2, options), CellState::kFree);
  EXPECT_EQ(StateAt(3.9, 2, options), CellState::kUnknown);
}

TEST(ClassifyBlock, OverlappingThresholdsPreferOccupied) {
  OccupancyOptions options;
  options.occupied_max_voxels = 3;
  options.free_min_voxels = 1;
  EXPECT_EQ(StateAt(2.0, 2, options), CellState::kOccupied);
}

TEST(ClassifyBlock, FreeBlocksNeedTheSecondObservation) {
  Block block;
  block.free = std::make_unique<FreeVoxels>();
  block.free->once[1] = 0b111;
  block.free->twice[1] = 0b010;
  OccupancyOptions options;
  const BlockOccupancy twice = ClassifyBlock(block, kGrid, options);
  EXPECT_EQ(twice.At(64), CellState::kUnknown);
  EXPECT_EQ(twice.At(65), CellState::kFree);
  options.min_observations = 1;
  EXPECT_EQ(ClassifyBlock(block, kGrid, options).At(64), CellState::kFree);
  options.min_observations = 5;
  EXPECT_EQ(ClassifyBlock(block, kGrid, options), twice) << "free blocks count to two";
}

TEST(ClassifyBlock, AllFreeIsUniformFreeAndNothingIsUnknown) {
  Block block;
  EXPECT_TRUE(ClassifyBlock(block, kGrid, {}).is(CellState::kUnknown));
  block.all_free = true;
  EXPECT_TRUE(ClassifyBlock(block, kGrid, {}).is(CellState::kFree));
}

TEST(BlockOccupancy, UniformPlanesAreTheSameAsUniform) {
  for (const CellState state : {CellState::kUnknown, CellState::kFree, CellState::kOccupied}) {
    const BlockOccupancy uniform(state);
    const BlockOccupancy again(uniform.Planes());
    EXPECT_TRUE(again.is(state));
    EXPECT_EQ(again, uniform);
  }
  OccupancyPlanes both;
  both.free[0] = both.occupied[0] = 1;
  EXPECT_THROW(BlockOccupancy{both}, std::logic_error);
}

/// Fraction of the cells whose centre fulfils `where` that have the state.
template <typename Where>
double Share(const OccupancyMap& map, const testing_support::AnalyticRegion& region,
             CellState state, const Where& where) {
  int all = 0;
  int matching = 0;
  const double size = map.cell_size();
  for (double z = region.min_W.z() + size / 2; z < region.max_W.z(); z += size) {
    for (double y = region.min_W.y() + size / 2; y < region.max_W.y(); y += size) {
      for (double x = region.min_W.x() + size / 2; x < region.max_W.x(); x += size) {
        const Eigen::Vector3d p_W(x, y, z);
        if (!where(p_W)) continue;
        ++all;
        matching += map.At(p_W) == state;
      }
    }
  }
  EXPECT_GT(all, 0);
  return static_cast<double>(matching) / all;
}

TEST(ClassifyMap, PanelOfTwoVoxelsHasNoFreeHoleAndIsOccupied) {
  testing_support::AnalyticScene scene;
  const Eigen::Vector3d center(0.003, 0.004, 0.002);
  scene.distance = [&](const Eigen::Vector3d& p) {
    return testing_support::BoxDistance(p, center, {0.15, 0.01, 0.15});
  };
  testing_support::AnalyticRegion region;
  region.min_W.setConstant(-0.3);
  region.max_W.setConstant(0.3);
  const OccupancyMap map = ClassifyMap(MakeAnalyticMap(scene, region, kGrid), {});
  const auto solid = [&](const Eigen::Vector3d& p) { return scene.distance(p) <= 0; };
  EXPECT_EQ(Share(map, region, CellState::kOccupied, solid), 1.0);
  const auto open = [&](const Eigen::Vector3d& p) { return scene.distance(p) > 0.02; };
  EXPECT_GT(Share(map, region, CellState::kFree, open), 0.999);
}

TEST(ClassifyMap, WhatWasNeverSeenIsNeverFree) {
  testing_support::AnalyticScene scene;
  scene.distance = [](const Eigen::Vector3d& p) {
    return testing_support::SphereDistance(p, {0, 0, 0}, 0.12);
  };
  testing_support::AnalyticRegion region;
  region.min_W = {-0.3, -0.25, -0.21};
  region.max_W = {0.11, 0.3, 0.3};
  const SemanticMap map = MakeAnalyticMap(scene, region, kGrid);
  const OccupancyMap occupancy = ClassifyMap(map, {});
  int free = 0;
  for (int z = -45; z < 45; ++z) {
    for (int y = -45; y < 45; ++y) {
      for (int x = -45; x < 45; ++x) {
        const VoxelIndex voxel{x, y, z};
        if (!ReadVoxel(map.voxels, voxel)) {
          EXPECT_EQ(occupancy.At(voxel), CellState::kUnknown);
        }
        if (occupancy.At(voxel) != CellState::kFree) continue;
        ++free;
        EXPECT_GE(scene.distance(VoxelCenter(map.voxels, voxel)), 0.0199);
      }
    }
  }
  EXPECT_GT(free, 50000);
}

}  // namespace
}  // namespace vismap
