#include "navigation/floor_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"

namespace vismap {
namespace {

constexpr double kSlopeOver = 0.3;  // slopes are measured over this way [m]
constexpr double kSeedReach = 1.0;  // floor is looked for so far around a place of the path [m]
constexpr int kSeedStride = 4;      // without a path, every so many cells along x and y

struct GridCell {
  int x = 0, y = 0;
};

/// A place that may be on the floor.
struct Seed {
  GridCell cell;
  int32_t height = 0;
};

constexpr std::array<GridCell, 4> kBeside = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// The height of the floor in a cell, if there is something to stand on in at least half of its
/// columns within from <= z < to, and it is level within a step.
std::optional<int32_t> LevelIn(const GridOfColumns& grid, GridCell cell, int32_t from, int32_t to,
                               int32_t step) {
  static thread_local std::vector<int32_t> heights;
  heights.clear();
  grid.ForEachColumn(cell.x, cell.y, [&](int32_t x, int32_t y) {
    if (const auto height = grid.columns->HighestSupport(x, y, from, to))
      heights.push_back(*height);
  });
  if (2 * static_cast<int>(heights.size()) < grid.factor * grid.factor) return std::nullopt;
  std::sort(heights.begin(), heights.end());
  if (heights.back() - heights.front() > step) return std::nullopt;
  return heights[heights.size() / 2];
}

/// A cell of a floor.
struct Reached {
  GridCell cell;
  int32_t height = 0;
};

/// All cells that can be reached from a seed. `heights` must be kNoFloor everywhere, and is so
/// again afterwards.
std::vector<Reached> SpreadFrom(const GridOfColumns& grid, const Seed& seed, int32_t step,
                                std::vector<int32_t>* heights) {
  std::vector<Reached> reached = {{seed.cell, seed.height}};
  (*heights)[grid.Index(seed.cell.x, seed.cell.y)] = seed.height;
  for (size_t next = 0; next < reached.size(); ++next) {
    const Reached from = reached[next];
    for (const GridCell& beside : kBeside) {
      const GridCell to{from.cell.x + beside.x, from.cell.y + beside.y};
      if (!grid.Contains(to.x, to.y)) continue;
      int32_t& found = (*heights)[grid.Index(to.x, to.y)];
      if (found != kNoFloor) continue;
      const auto level = LevelIn(grid, to, from.height - step, from.height + step + 1, step);
      if (!level) continue;
      found = *level;
      reached.push_back({to, *level});
    }
  }
  for (const Reached& at : reached) (*heights)[grid.Index(at.cell.x, at.cell.y)] = kNoFloor;
  return reached;
}

/// The cell nearest to a place of the path that has something to stand on below it.
std::optional<Seed> SeedBelow(const GridOfColumns& grid, const Eigen::Vector3d& p_W, double voxel_m,
                              int32_t step) {
  const double cell_m = voxel_m * grid.factor;
  const Eigen::Vector3d p = p_W / voxel_m;
  if (!p.allFinite() || p.cwiseAbs().maxCoeff() > 1e9) return std::nullopt;
  const auto below = static_cast<int32_t>(std::floor(p.z()));
  const int x = static_cast<int>(std::floor(p.x() / grid.factor)) - grid.first_x;
  const int y = static_cast<int>(std::floor(p.y() / grid.factor)) - grid.first_y;
  const int reach = static_cast<int>(kSeedReach / cell_m);
  for (int ring = 0; ring <= reach; ++ring) {
    for (int dy = -ring; dy <= ring; ++dy) {
      const int stride = std::abs(dy) == ring ? 1 : 2 * ring;
      for (int dx = -ring; dx <= ring; dx += std::max(1, stride)) {
        const GridCell cell{x + dx, y + dy};
        if (!grid.Contains(cell.x, cell.y)) continue;
        const auto level = LevelIn(grid, cell, grid.columns->box().min.z, below, step);
        if (level) return Seed{cell, *level};
      }
    }
  }
  return std::nullopt;
}

std::vector<Seed> FindSeeds(const GridOfColumns& grid, const FloorLimits& limits, double voxel_m,
                            std::span<const Eigen::Vector3d> path_W) {
  std::vector<Seed> seeds;
  for (const Eigen::Vector3d& p_W : path_W) {
    if (const auto seed = SeedBelow(grid, p_W, voxel_m, limits.step)) seeds.push_back(*seed);
  }
  if (!path_W.empty()) return seeds;
  const OccupancyBox& box = grid.columns->box();
  for (int y = 0; y < grid.height; y += kSeedStride) {
    for (int x = 0; x < grid.width; x += kSeedStride) {
      const auto level = LevelIn(grid, {x, y}, box.min.z, box.max.z, limits.step);
      if (level) seeds.push_back({{x, y}, *level});
    }
  }
  return seeds;
}

/// The heights of the floors that were found so far, at most two for each cell; when there are
/// more, a floor may be found again, which costs time only.
class FloorsSoFar {
 public:
  FloorsSoFar(size_t cells, int32_t step) : heights_(cells, {kNoFloor, kNoFloor}), step_(step) {}

  void Add(size_t index, int32_t height) {
    std::array<int32_t, 2>& at = heights_[index];
    (at[0] == kNoFloor ? at[0] : at[1]) = height;
  }
  bool Has(size_t index, int32_t height) const {
    const auto same = [&](int32_t h) { return h != kNoFloor && std::abs(h - height) <= step_; };
    return same(heights_[index][0]) || same(heights_[index][1]);
  }

 private:
  std::vector<std::array<int32_t, 2>> heights_;
  int32_t step_;
};

/// The largest floor that can be reached from any of the seeds, by cell; the first one of those of
/// equal size.
std::vector<int32_t> LargestFloor(const GridOfColumns& grid, std::span<const Seed> seeds,
                                  int32_t step) {
  const size_t count = static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height);
  std::vector<int32_t> heights(count, kNoFloor);
  FloorsSoFar so_far(count, step);
  std::vector<Reached> largest;
  for (const Seed& seed : seeds) {
    if (so_far.Has(grid.Index(seed.cell.x, seed.cell.y), seed.height)) continue;
    std::vector<Reached> floor = SpreadFrom(grid, seed, step, &heights);
    for (const Reached& at : floor) so_far.Add(grid.Index(at.cell.x, at.cell.y), at.height);
    if (floor.size() > largest.size()) largest = std::move(floor);
  }
  for (const Reached& at : largest) heights[grid.Index(at.cell.x, at.cell.y)] = at.height;
  return heights;
}

/// For cells without floor the height of the nearest one that has some.
std::vector<int32_t> SpreadHeights(const GridOfColumns& grid, std::vector<int32_t> heights) {
  std::vector<GridCell> queue;
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      if (heights[grid.Index(x, y)] != kNoFloor) queue.push_back({x, y});
    }
  }
  for (size_t next = 0; next < queue.size(); ++next) {
    const GridCell from = queue[next];
    for (const GridCell& beside : kBeside) {
      const GridCell to{from.x + beside.x, from.y + beside.y};
      if (!grid.Contains(to.x, to.y) || heights[grid.Index(to.x, to.y)] != kNoFloor) continue;
      heights[grid.Index(to.x, to.y)] = heights[grid.Index(from.x, from.y)];
      queue.push_back(to);
    }
  }
  return heights;
}

/// Decides the states of cells, see MakeGroundGrid.
class FloorJudge {
 public:
  FloorJudge(const GridOfColumns& grid, const FloorLimits& limits,
             const std::vector<int32_t>& heights)
      : grid_(grid), limits_(limits), heights_(heights), around_(SpreadHeights(grid, heights)) {}

  CellState StateOf(int x, int y) const {
    const size_t index = grid_.Index(x, y);
    if (around_[index] == kNoFloor) return CellState::kUnknown;
    bool occupied = heights_[index] != kNoFloor && RisesTooMuch(x, y);
    bool free = heights_[index] != kNoFloor;
    grid_.ForEachColumn(x, y, [&](int32_t cx, int32_t cy) {
      const CellState state = StateOfColumn(cx, cy, around_[index]);
      occupied = occupied || state == CellState::kOccupied;
      free = free && state == CellState::kFree;
    });
    if (occupied) return CellState::kOccupied;
    return free ? CellState::kFree : CellState::kUnknown;
  }

 private:
  CellState StateOfColumn(int32_t x, int32_t y, int32_t height) const {
    const CellColumns& columns = *grid_.columns;
    const int32_t step = limits_.step;
    const auto support = columns.HighestSupport(x, y, height - step, height + step + 1);
    const int32_t floor = support.value_or(height);
    // Without support anything from the step height on is in the way; on it, what is above it.
    if (columns.AnyOccupied(x, y, support ? floor : height + step, height + limits_.body))
      return CellState::kOccupied;
    if (!support && DropsBelow(x, y, height)) return CellState::kOccupied;
    const int32_t from = floor + std::max(step, kUnsureCells);
    return columns.AllFree(x, y, from, std::max(from, height + limits_.body)) ? CellState::kFree
                                                                              : CellState::kUnknown;
  }

  // Whether space below the floor was seen empty, or other floor there.
  bool DropsBelow(int32_t x, int32_t y, int32_t height) const {
    const CellColumns& columns = *grid_.columns;
    const int32_t lowest = columns.box().min.z, below = height - limits_.step;
    return columns.AnyFree(x, y, lowest, below - kUnsureCells) ||
           columns.HighestSupport(x, y, lowest, below);
  }

  bool RisesTooMuch(int x, int y) const {
    const int d = limits_.half_way;
    for (const GridCell& way : {GridCell{d, 0}, GridCell{0, d}, GridCell{d, d}, GridCell{d, -d}}) {
      const int32_t before = HeightOr(x - way.x, y - way.y, heights_[grid_.Index(x, y)]);
      const int32_t behind = HeightOr(x + way.x, y + way.y, heights_[grid_.Index(x, y)]);
      if (std::abs(before - behind) > limits_.rise) return true;
    }
    return false;
  }

  int32_t HeightOr(int x, int y, int32_t otherwise) const {
    if (!grid_.Contains(x, y)) return otherwise;
    const int32_t height = heights_[grid_.Index(x, y)];
    return height != kNoFloor ? height : otherwise;
  }

  const GridOfColumns& grid_;
  const FloorLimits& limits_;
  const std::vector<int32_t>& heights_;
  std::vector<int32_t> around_;
};

}  // namespace

FloorLimits LimitsOf(const GroundGridOptions& options, double voxel_m, int factor) {
  const double cell_m = voxel_m * factor;
  FloorLimits limits;
  limits.step = static_cast<int32_t>(std::floor(options.step_height_m / voxel_m + 1e-6));
  limits.body = static_cast<int32_t>(std::ceil(options.robot_height_m / voxel_m - 1e-6));
  limits.half_way = std::max(1, static_cast<int>(std::lround(kSlopeOver / 2 / cell_m)));
  const double way = 2 * limits.half_way * cell_m;
  const double slope = std::tan(options.max_slope_deg * std::numbers::pi / 180);
  const double rise = std::max(options.step_height_m, slope * way);
  // Heights are known to one voxel.
  limits.rise = static_cast<int32_t>(std::floor(rise / voxel_m + 1e-6)) + 1;
  return limits;
}

Floor FindFloor(const GridOfColumns& grid, const FloorLimits& limits, double voxel_m,
                std::span<const Eigen::Vector3d> path_W) {
  Floor floor;
  const size_t count = static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height);
  floor.states.assign(count, CellState::kUnknown);
  floor.heights = LargestFloor(grid, FindSeeds(grid, limits, voxel_m, path_W), limits.step);
  const FloorJudge judge(grid, limits, floor.heights);
  ParallelFor(static_cast<size_t>(grid.height), 4, [&](size_t y) {
    for (int x = 0; x < grid.width; ++x)
      floor.states[grid.Index(x, static_cast<int>(y))] = judge.StateOf(x, static_cast<int>(y));
  });
  return floor;
}

}  // namespace vismap
