#pragma once

#include "freespace/occupancy_map.h"

namespace vismap::testing_support {

/// All blocks of an occupancy map, as a complete delta.
inline OccupancyDelta SnapshotOf(const OccupancyMap& map) {
  OccupancyDelta delta{map.cell_size(), true, {}};
  for (const BlockIndex& index : map.SortedIndices())
    delta.blocks.emplace_back(index, map.At(index));
  return delta;
}

}  // namespace vismap::testing_support
