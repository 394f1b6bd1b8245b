#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "navigation/cell_columns.h"
#include "navigation/ground_grid.h"

namespace vismap {

/// The cells of a 2-D grid, each with factor x factor columns of voxels.
struct GridOfColumns {
  const CellColumns* columns = nullptr;
  int factor = 1;
  int32_t first_x = 0, first_y = 0;  ///< cell (0, 0), counted from the origin of W
  int width = 0, height = 0;

  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
  bool Contains(int x, int y) const { return x >= 0 && x < width && y >= 0 && y < height; }
  /// Calls `visit(x, y)` with the voxel coordinates of each column of a cell.
  template <typename Visit>
  void ForEachColumn(int x, int y, const Visit& visit) const {
    for (int dy = 0; dy < factor; ++dy) {
      for (int dx = 0; dx < factor; ++dx)
        visit((first_x + x) * factor + dx, (first_y + y) * factor + dy);
    }
  }
};

/// GroundGridOptions in voxels and cells.
struct FloorLimits {
  int32_t step = 0;  ///< highest step [voxels]
  int32_t body = 0;  ///< height of the robot [voxels]
  int32_t rise = 0;  ///< most that the floor may rise over twice `half_way` [voxels]
  int half_way = 1;  ///< [cells]
};
FloorLimits LimitsOf(const GroundGridOptions& options, double voxel_m, int factor);

inline constexpr int32_t kNoFloor = std::numeric_limits<int32_t>::min();

/// The floor of a grid, by GridOfColumns::Index.
struct Floor {
  std::vector<int32_t> heights;  ///< the lowest voxel above the floor, or kNoFloor
  std::vector<CellState> states;
};

/// Finds the floor below a path [m], see MakeGroundGrid.
Floor FindFloor(const GridOfColumns& grid, const FloorLimits& limits, double voxel_m,
                std::span<const Eigen::Vector3d> path_W);

}  // namespace vismap
