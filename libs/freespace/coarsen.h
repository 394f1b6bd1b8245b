#pragma once

#include <span>

#include "freespace/occupancy_map.h"

namespace vismap {

/// How cells of `factor`^3 voxels follow from their voxels: occupied when any voxel is, free when
/// none is and enough of them are free, else unknown.
struct CoarsenOptions {
  int factor = 5;              ///< voxels along the edge of a cell, 1..64
  double free_fraction = 1.0;  ///< part of the voxels that must be free, (0, 1]
};

/// Block `index` of the coarser map: 8x8x8 cells, made of exactly factor^3 blocks of `fine`.
BlockOccupancy CoarsenBlock(const OccupancyMap& fine, BlockIndex index,
                            const CoarsenOptions& options);

/// The whole map in coarser cells.
OccupancyMap Coarsen(const OccupancyMap& fine, const CoarsenOptions& options);

/// Brings a coarser map up to date after the given blocks of `fine` changed; returns the blocks of
/// `coarse` that are different. The same as coarsening everything again.
OccupancyDelta UpdateCoarse(const OccupancyMap& fine, std::span<const BlockIndex> changed,
                            const CoarsenOptions& options, OccupancyMap* coarse);

}  // namespace vismap
