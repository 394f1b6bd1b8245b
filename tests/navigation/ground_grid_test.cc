#include "navigation/ground_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <vector>

namespace vismap {
namespace {

constexpr double kVoxel = 0.01;

/// A world of a floor with a height at each place, and of boxes that stand or hang above it.
struct World {
  std::function<double(double x, double y)> floor = [](double, double) { return 0.0; };
  std::vector<Eigen::AlignedBox3d> boxes;
  std::function<bool(const Eigen::Vector3d&)> seen = [](const Eigen::Vector3d&) { return true; };

  double Distance(const Eigen::Vector3d& p) const {
    double distance = p.z() - floor(p.x(), p.y());
    for (const Eigen::AlignedBox3d& box : boxes) {
      const double outside = box.exteriorDistance(p);
      distance = std::min(distance, outside > 0 ? outside : -0.01);
    }
    return distance;
  }
  /// As ClassifyBlock would do it: deep inside of solids nothing is seen.
  CellState StateAt(const Eigen::Vector3d& p) const {
    const double distance = Distance(p) / kVoxel;
    if (!seen(p) || distance < -4) return CellState::kUnknown;
    if (distance <= 1) return CellState::kOccupied;
    return distance >= 2 ? CellState::kFree : CellState::kUnknown;
  }
};

/// The voxels of a world with 0 <= x < 4 m, 0 <= y < 1.6 m, -0.48 <= z < 1.6 m.
OccupancyMap MapOf(const World& world) {
  OccupancyMap map(kVoxel);
  for (int bz = -6; bz < 20; ++bz) {
    for (int by = 0; by < 20; ++by) {
      for (int bx = 0; bx < 50; ++bx) {
        OccupancyPlanes planes;
        for (size_t i = 0; i < kBlockVoxels; ++i) {
          const int x = static_cast<int>(i % 8), y = static_cast<int>(i / 8 % 8);
          const int z = static_cast<int>(i / 64);
          const Eigen::Vector3d p(8 * bx + x + 0.5, 8 * by + y + 0.5, 8 * bz + z + 0.5);
          const CellState state = world.StateAt(p * kVoxel);
          planes.occupied[i / 64] |= uint64_t{state == CellState::kOccupied} << (i % 64);
          planes.free[i / 64] |= uint64_t{state == CellState::kFree} << (i % 64);
        }
        map.Set({bx, by, bz}, BlockOccupancy(planes));
      }
    }
  }
  return map;
}

const std::vector<Eigen::Vector3d> kPath = {{0.4, 0.8, 1.2}};

GroundGrid GridOf(const World& world, const GroundGridOptions& options = {},
                  const std::vector<Eigen::Vector3d>& path = kPath) {
  Result<GroundGrid> grid = MakeGroundGrid(MapOf(world), options, path);
  EXPECT_TRUE(grid) << grid.error().message;
  return std::move(*grid);
}

size_t At(const GroundGrid& grid, double x, double y) {
  return grid.Index(static_cast<int>(std::floor((x - grid.origin_W.x()) / grid.resolution_m)),
                    static_cast<int>(std::floor((y - grid.origin_W.y()) / grid.resolution_m)));
}

CellState StateAt(const GroundGrid& grid, double x, double y = 0.8) {
  return grid.states[At(grid, x, y)];
}

/// The share of the cells with x0 <= x < x1 that have a state.
double ShareOf(const GroundGrid& grid, CellState state, double x0, double x1) {
  int all = 0, with = 0;
  for (double x = x0 + 0.025; x < x1; x += 0.05) {
    for (double y = 0.125; y < 1.45; y += 0.05) {
      ++all;
      with += StateAt(grid, x, y) == state;
    }
  }
  return static_cast<double>(with) / all;
}

TEST(GroundGrid, LevelFloorIsFreeAndHasItsHeight) {
  World world;
  world.floor = [](double, double) { return 0.2; };
  const GroundGrid grid = GridOf(world);
  EXPECT_EQ(grid.resolution_m, 0.05);
  EXPECT_EQ(grid.width, 80);
  EXPECT_EQ(grid.height, 32);
  EXPECT_EQ(ShareOf(grid, CellState::kFree, 0, 4), 1);
  EXPECT_NEAR(static_cast<double>(grid.floor_m[At(grid, 2, 1)]), 0.2, kVoxel);
}

TEST(GroundGrid, LowStepsAreTakenAndHighOnesAreOccupied) {
  for (const auto& [height, taken] : std::map<double, bool>{{0.03, true}, {0.06, false}}) {
    for (const double sign : {1.0, -1.0}) {
      World world;
      world.floor = [&](double x, double) { return x < 2 ? 0 : sign * height; };
      const GroundGrid grid = GridOf(world);
      EXPECT_EQ(ShareOf(grid, CellState::kFree, 0, 1.8), 1);
      if (taken) {
        EXPECT_EQ(ShareOf(grid, CellState::kFree, 1.8, 4), 1) << height * sign;
      } else {
        EXPECT_EQ(ShareOf(grid, CellState::kFree, 2, 4), 0) << height * sign;
        EXPECT_EQ(StateAt(grid, 2.025), CellState::kOccupied) << height * sign;
      }
    }
  }
}

/// A ramp from x = 1 to x = 2.4.
World Ramp(double degrees) {
  World world;
  const double slope = std::tan(degrees * 3.14159265 / 180);
  world.floor = [slope](double x, double) { return slope * std::clamp(x - 1, 0.0, 1.4); };
  return world;
}

TEST(GroundGrid, RampsWithinTheSlopeAreFreeAndSteeperOnesOccupied) {
  EXPECT_EQ(ShareOf(GridOf(Ramp(8)), CellState::kFree, 0, 4), 1);
  EXPECT_EQ(ShareOf(GridOf(Ramp(-8)), CellState::kFree, 0, 4), 1);
  for (const double steep : {17.0, 25.0, 40.0, -17.0}) {
    const GroundGrid grid = GridOf(Ramp(steep));
    EXPECT_EQ(ShareOf(grid, CellState::kFree, 0, 0.8), 1) << steep;
    EXPECT_EQ(ShareOf(grid, CellState::kOccupied, 1.2, 2.2), 1) << steep;
  }
  GroundGridOptions climber;
  climber.max_slope_deg = 30;
  climber.step_height_m = 0.05;
  climber.robot_height_m = 0.5;
  EXPECT_GT(ShareOf(GridOf(Ramp(25), climber), CellState::kFree, 0, 4), 0.99);
}

TEST(GroundGrid, WhatHangsLowerThanTheRobotIsOccupied) {
  World world;
  world.boxes.push_back({Eigen::Vector3d(2, -1, 0.7), Eigen::Vector3d(3, 3, 0.74)});
  const GroundGrid tall = GridOf(world);
  EXPECT_EQ(ShareOf(tall, CellState::kOccupied, 2, 3), 1);
  EXPECT_EQ(ShareOf(tall, CellState::kFree, 0, 1.9), 1);
  EXPECT_EQ(ShareOf(tall, CellState::kFree, 3.1, 4), 1);
  GroundGridOptions low;
  low.robot_height_m = 0.5;
  EXPECT_EQ(ShareOf(GridOf(world, low), CellState::kFree, 0, 4), 1);
}

TEST(GroundGrid, ThingsOnTheFloorAreOccupied) {
  World world;
  world.boxes.push_back({Eigen::Vector3d(2, 0.7, 0), Eigen::Vector3d(2.2, 0.9, 0.08)});
  world.boxes.push_back({Eigen::Vector3d(3, 0.7, 0), Eigen::Vector3d(3.02, 0.72, 1.5)});
  const GroundGrid grid = GridOf(world);
  EXPECT_EQ(StateAt(grid, 2.1), CellState::kOccupied);
  EXPECT_EQ(StateAt(grid, 3.01, 0.71), CellState::kOccupied);
  EXPECT_EQ(StateAt(grid, 2.1, 0.4), CellState::kFree);
  EXPECT_EQ(StateAt(grid, 3.3), CellState::kFree);
}

TEST(GroundGrid, DropThatWasSeenIsOccupiedAndWhatWasNotSeenUnknown) {
  World world;
  world.floor = [](double x, double) { return x < 2 ? 0 : -0.4; };
  EXPECT_EQ(ShareOf(GridOf(world), CellState::kOccupied, 2, 4), 1);
  World half_seen;
  half_seen.seen = [](const Eigen::Vector3d& p) { return p.x() < 2 || p.z() > 0.6; };
  const GroundGrid grid = GridOf(half_seen);
  EXPECT_EQ(ShareOf(grid, CellState::kFree, 0, 1.95), 1);
  EXPECT_EQ(ShareOf(grid, CellState::kUnknown, 2.05, 4), 1);
}

TEST(GroundGrid, UnseenSpaceAboveTheFloorIsUnknown) {
  World world;
  world.seen = [](const Eigen::Vector3d& p) { return p.x() < 2 || p.z() < 0.5; };
  const GroundGrid grid = GridOf(world);
  EXPECT_EQ(ShareOf(grid, CellState::kUnknown, 2.05, 4), 1);
  GroundGridOptions low;
  low.robot_height_m = 0.4;
  EXPECT_EQ(ShareOf(GridOf(world, low), CellState::kFree, 0, 4), 1);
}

TEST(GroundGrid, LargestFloorBelowThePathCounts) {
  World world;  // the camera is above a table most of the time
  world.boxes.push_back({Eigen::Vector3d(0.1, 0.4, 0.7), Eigen::Vector3d(0.9, 1.2, 0.74)});
  const std::vector<Eigen::Vector3d> path = {{0.4, 0.8, 1.2}, {0.5, 0.8, 1.2}, {1.5, 0.8, 1.2}};
  for (const auto& which : {path, std::vector<Eigen::Vector3d>()}) {
    const GroundGrid grid = GridOf(world, {}, which);
    EXPECT_EQ(StateAt(grid, 3), CellState::kFree);
    EXPECT_EQ(StateAt(grid, 0.5), CellState::kOccupied);
    EXPECT_NEAR(static_cast<double>(grid.floor_m[At(grid, 3, 0.8)]), 0, kVoxel);
  }
}

TEST(GroundGrid, BandCountsEverythingBetweenItsHeights) {
  World world;
  world.boxes.push_back({Eigen::Vector3d(2, -1, 0.7), Eigen::Vector3d(3, 3, 0.74)});
  GroundGridOptions options;
  options.band_min_m = 0.3;
  options.band_max_m = 0.5;
  EXPECT_EQ(ShareOf(GridOf(world, options), CellState::kFree, 0, 4), 1);
  options.band_max_m = 0.9;
  const GroundGrid grid = GridOf(world, options);
  EXPECT_EQ(ShareOf(grid, CellState::kOccupied, 2, 3), 1);
  EXPECT_EQ(ShareOf(grid, CellState::kFree, 0, 1.9), 1);
  EXPECT_TRUE(std::isnan(grid.floor_m[At(grid, 1, 1)]));
}

TEST(GroundGrid, DistancesEqualBruteForce) {
  World world;
  world.boxes.push_back({Eigen::Vector3d(2, 0.7, 0), Eigen::Vector3d(2.2, 0.9, 1)});
  const GroundGrid grid = GridOf(world, {.distance_limit_m = 0.5});
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      double least = 0.5;
      for (int oy = -1; oy <= grid.height; ++oy) {
        for (int ox = -1; ox <= grid.width; ++ox) {
          const bool inside = ox >= 0 && ox < grid.width && oy >= 0 && oy < grid.height;
          if (inside && grid.states[grid.Index(ox, oy)] == CellState::kFree) continue;
          const double dx = std::max(0.0, std::abs(ox - x) - 0.5);
          const double dy = std::max(0.0, std::abs(oy - y) - 0.5);
          least = std::min(least, std::hypot(dx, dy) * grid.resolution_m);
        }
      }
      ASSERT_NEAR(static_cast<double>(grid.distances_m[grid.Index(x, y)]), least, 1e-6)
          << x << " " << y;
    }
  }
}

TEST(GroundGrid, RefusesBadOptionsAndMapsThatAreTooLarge) {
  const OccupancyMap empty(kVoxel);
  GroundGridOptions options;
  options.robot_height_m = std::nan("");
  EXPECT_NE(MakeGroundGrid(empty, options, {}).error().message.find("robot_height_m"),
            std::string::npos);
  options = {.band_min_m = 1, .band_max_m = 0.5};
  EXPECT_NE(MakeGroundGrid(empty, options, {}).error().message.find("band_max_m"),
            std::string::npos);
  OccupancyMap wide(kVoxel);
  for (const int at : {-100000, 100000}) wide.Set({at, at, 0}, BlockOccupancy(CellState::kFree));
  EXPECT_NE(MakeGroundGrid(wide, {}, {}).error().message.find("expected at most 1.07 GB"),
            std::string::npos)
      << MakeGroundGrid(wide, {}, {}).error().message;
  EXPECT_EQ(MakeGroundGrid(empty, {}, kPath)->width, 0);
}

}  // namespace
}  // namespace vismap
