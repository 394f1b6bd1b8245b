#include "navigation/ground_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/option_check.h"
#include "freespace/octree.h"
#include "freespace/shortest_text.h"
#include "navigation/cell_columns.h"
#include "navigation/floor_search.h"

namespace vismap {
namespace {

/// The columns of the map in cells of the grid.
GridOfColumns GridOver(const OccupancyMap& map, const CellColumns& columns, int factor) {
  GridOfColumns grid{&columns, factor, 0, 0, 0, 0};
  const std::optional<OccupancyBox> known = map.KnownCells();
  if (!known) return grid;
  const auto down = [&](int32_t cell) {
    return static_cast<int32_t>(std::floor(static_cast<double>(cell) / factor));
  };
  grid.first_x = down(known->min.x);
  grid.first_y = down(known->min.y);
  grid.width = down(known->max.x - 1) - grid.first_x + 1;
  grid.height = down(known->max.y - 1) - grid.first_y + 1;
  return grid;
}

/// The state of a cell, if everything between two heights [cells of the map] counts.
CellState StateInBand(const GridOfColumns& grid, int x, int y, int32_t from, int32_t to) {
  bool all_free = true, any_occupied = false;
  grid.ForEachColumn(x, y, [&](int32_t cx, int32_t cy) {
    any_occupied = any_occupied || grid.columns->AnyOccupied(cx, cy, from, to);
    all_free = all_free && grid.columns->AllFree(cx, cy, from, to);
  });
  if (any_occupied) return CellState::kOccupied;
  return all_free ? CellState::kFree : CellState::kUnknown;
}

void FillBand(const GridOfColumns& columns, double cell_m, const GroundGridOptions& options,
              GroundGrid* grid) {
  const auto from = static_cast<int32_t>(std::floor(options.band_min_m / cell_m + 1e-6));
  const auto to = static_cast<int32_t>(std::ceil(options.band_max_m / cell_m - 1e-6));
  for (int y = 0; y < grid->height; ++y) {
    for (int x = 0; x < grid->width; ++x)
      grid->states[grid->Index(x, y)] = StateInBand(columns, x, y, from, std::max(to, from + 1));
  }
}

void FillFloor(const GridOfColumns& columns, double cell_m, const GroundGridOptions& options,
               std::span<const Eigen::Vector3d> path_W, GroundGrid* grid) {
  const Floor floor = FindFloor(columns, LimitsOf(options, cell_m, columns.factor), cell_m, path_W);
  for (size_t i = 0; i < grid->states.size(); ++i) {
    grid->states[i] = floor.states[i];
    if (floor.heights[i] != kNoFloor)
      grid->floor_m[i] = static_cast<float>((floor.heights[i] - 1) * cell_m);
  }
}

/// Half cells squared to the nearest face of a cell that is not free, along one axis.
int HalfCells2(int cells) {
  const int half_cells = cells == 0 ? 0 : 2 * cells - 1;
  return half_cells * half_cells;
}

/// For each cell, how many cells it is to the nearest one in its row that is not free; those
/// outside of the grid are not free.
std::vector<int> DistancesInRows(const GroundGrid& grid) {
  std::vector<int> cells(grid.states.size());
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0, since = 0; x < grid.width; ++x) {
      since = grid.states[grid.Index(x, y)] == CellState::kFree ? since + 1 : 0;
      cells[grid.Index(x, y)] = since;
    }
    for (int x = grid.width - 1, since = 0; x >= 0; --x) {
      since = grid.states[grid.Index(x, y)] == CellState::kFree ? since + 1 : 0;
      cells[grid.Index(x, y)] = std::min(cells[grid.Index(x, y)], since);
    }
  }
  return cells;
}

int Nearest2(const GroundGrid& grid, const std::vector<int>& in_rows, int x, int y, int window) {
  int least = HalfCells2(in_rows[grid.Index(x, y)]);
  for (int d = 1; d <= window && HalfCells2(d) < least; ++d) {
    for (const int row : {y - d, y + d}) {
      const bool outside = row < 0 || row >= grid.height;
      const int across = outside ? 0 : HalfCells2(in_rows[grid.Index(x, row)]);
      least = std::min(least, HalfCells2(d) + across);
    }
  }
  return least;
}

void FillDistances(double limit_m, GroundGrid* grid) {
  const std::vector<int> in_rows = DistancesInRows(*grid);
  const int window = static_cast<int>(std::ceil(limit_m / grid->resolution_m)) + 1;
  for (int y = 0; y < grid->height; ++y) {
    for (int x = 0; x < grid->width; ++x) {
      const double distance =
          std::sqrt(Nearest2(*grid, in_rows, x, y, window)) / 2 * grid->resolution_m;
      grid->distances_m[grid->Index(x, y)] = static_cast<float>(std::min(distance, limit_m));
    }
  }
}

}  // namespace

std::vector<std::string> Validate(const GroundGridOptions& options) {
  OptionCheck check;
  VISMAP_CHECK_RANGE(check, options.resolution_m, 0, 10);
  VISMAP_CHECK_RANGE(check, options.robot_height_m, 0.01, 10);
  VISMAP_CHECK_RANGE(check, options.step_height_m, 0, 1);
  VISMAP_CHECK_RANGE(check, options.max_slope_deg, 0, 60);
  VISMAP_CHECK_RANGE(check, options.band_min_m, -1000, 1000);
  VISMAP_CHECK_RANGE(check, options.band_max_m, -1000, 1000);
  VISMAP_CHECK_RANGE(check, options.distance_limit_m, 0, 100);
  check.Unless(options.band_max_m >= options.band_min_m,
               "band_max_m: expected at least band_min_m (" + ShortestText(options.band_min_m) +
                   "), found " + ShortestText(options.band_max_m));
  return std::move(check).problems();
}

Result<GroundGrid> MakeGroundGrid(const OccupancyMap& map, const GroundGridOptions& options,
                                  std::span<const Eigen::Vector3d> path_W) {
  if (const auto problems = Validate(options); !problems.empty())
    return Fail("ground grid: " + problems.front());
  const Result<OctreeGrid> chosen = ChooseOctreeGrid(map.cell_size(), options.resolution_m);
  if (!chosen) return Fail("ground grid: resolution_m: " + chosen.error().message);
  const Result<CellColumns> columns = CellColumns::Make(map);
  if (!columns) return tl::unexpected(columns.error());
  const GridOfColumns cells = GridOver(map, *columns, chosen->factor);
  GroundGrid grid;
  grid.resolution_m = chosen->resolution;
  grid.origin_W = Eigen::Vector2d(cells.first_x, cells.first_y) * chosen->resolution;
  grid.width = cells.width;
  grid.height = cells.height;
  const size_t count = static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height);
  grid.states.assign(count, CellState::kUnknown);
  grid.distances_m.assign(count, 0);
  grid.floor_m.assign(count, std::numeric_limits<float>::quiet_NaN());
  if (options.has_band()) {
    FillBand(cells, map.cell_size(), options, &grid);
  } else {
    FillFloor(cells, map.cell_size(), options, path_W, &grid);
  }
  FillDistances(options.distance_limit_m, &grid);
  return grid;
}

}  // namespace vismap
