#pragma once

#include "freespace/occupancy_map.h"

namespace vismap {

/// A cell of `factor`^3 voxels is occupied when any voxel is occupied, free when none is occupied
/// and enough voxels are free, else unknown.
struct CoarsenOptions {
  int factor = 5;              ///< voxels along the edge of a cell, 1..64
  double free_fraction = 1.0;  ///< share of the voxels that must be free, (0, 1]
};

/// Block `index` of the coarser map: 8x8x8 cells, made of factor^3 blocks of `fine`.
BlockOccupancy CoarsenBlock(const OccupancyMap& fine, BlockIndex index,
                            const CoarsenOptions& options);

/// The whole map in larger cells. Of a map that changes, a Coarsener keeps it up to date.
OccupancyMap Coarsen(const OccupancyMap& fine, const CoarsenOptions& options);

}  // namespace vismap
