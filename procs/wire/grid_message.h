#pragma once

#include <cstdint>
#include <string>
#include <vismap/occupancy_grid_t.hpp>

#include "navigation/ground_grid.h"

namespace vismap {

/// The content of one GRID message: a grid, and the map from which it was made.
struct GridMessage {
  int64_t utime = 0;            ///< of the newest frame in the map [us]
  int64_t published_utime = 0;  ///< when it was sent [us]
  std::string map_id;
  int64_t revision = 0;
  GroundGridOptions options;  ///< how it was made
  GroundGrid grid;
};

occupancy_grid_t Encode(const GridMessage& message);

/// Fails, naming the field, on a number of cells that differs from width times height, on states
/// that do not exist, and on lengths that are not finite or out of range.
Result<GridMessage> Decode(const occupancy_grid_t& message);

}  // namespace vismap
