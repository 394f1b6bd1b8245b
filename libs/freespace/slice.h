#pragma once

#include <Eigen/Core>

#include "freespace/occupancy_map.h"
#include "geometry/image.h"

namespace vismap {

/// One horizontal layer of cells.
struct OccupancySlice {
  Eigen::Vector2d origin_W = Eigen::Vector2d::Zero();  ///< lower corner (x, y) of cell (0, 0) [m]
  double cell_size = 0;                                ///< [m]
  double z_min = 0, z_max = 0;                         ///< of the layer [m]
  Image<CellState> states;  ///< row v along +y, column u along +x; empty = nothing known
};

/// The layer of cells at height z [m], over the whole extent of what the map knows.
OccupancySlice SliceAt(const OccupancyMap& map, double z);

}  // namespace vismap
