#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// A plane through free space, across one axis of W.
struct SliceQuestion {
  int axis = 2;       ///< 0, 1, 2 = x, y, z
  double at_m = 0;    ///< where on this axis
  double cell_m = 0;  ///< edge of a cell of the picture; 0 = a voxel
};
/// The two axes that a slice across `axis` has.
constexpr std::array<int, 2> OtherAxes(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

/// One byte per cell: 0 unknown, 1 free, 2 occupied, within the bounds of what is known of the
/// whole map. A cell of several voxels is occupied when one of them is, and free when all are.
struct Slice {
  double cell_m = 0;            ///< a whole number of voxels
  int64_t layer = 0;            ///< index of the voxels on the axis
  double origin_m[2] = {};      ///< corner of the first cell, on the other two axes
  int width = 0, height = 0;    ///< along the first and the second of the other axes
  std::vector<uint8_t> states;  ///< row by row, `height` rows of `width`
};
constexpr int64_t kMostSliceSide = 4096;  ///< cells
/// With more than `max_cells`, the cells get larger, and without a given size also when a side has
/// more than kMostSliceSide. Fails when a given size needs longer sides. Costs as much as the map
/// has blocks, and the 64 voxels of each block of the layer.
Result<Slice> CutSlice(const OccupancyMap& map, const SliceQuestion& question,
                       size_t max_cells = size_t{1} << 22);

}  // namespace vismap
