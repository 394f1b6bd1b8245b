#pragma once

#include <optional>

#include "freespace/block_region.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Replaces the blocks of `overlay` that lie in a region, or all of them (nullopt).
void LayOver(const OccupancyDelta& overlay, const std::optional<BlockRegion>& region,
             OccupancyMap* map);

/// A copy of the blocks of a region, or of all, with those of `overlay` in place of the
/// map's: what planners ask for when objects are left out (EditObjects). Trees, distances and grids
/// are made of it as of the map itself. Blocks are shared, so that the copy takes less than a
/// millisecond per cubic metre. Fails when the sizes of the cells differ.
Result<OccupancyMap> OccupancyWith(const OccupancyMap& map, const OccupancyDelta& overlay,
                                   const std::optional<BlockRegion>& region);

}  // namespace vismap
