#include "navigation/overlay.h"

#include <string>

namespace vismap {

void LayOver(const OccupancyDelta& overlay, const std::optional<BlockRegion>& region,
             OccupancyMap* map) {
  for (const auto& [index, occupancy] : overlay.blocks) {
    if (!region || region->Contains(index)) map->Set(index, occupancy);
  }
}

Result<OccupancyMap> OccupancyWith(const OccupancyMap& map, const OccupancyDelta& overlay,
                                   const std::optional<BlockRegion>& region) {
  if (overlay.voxel_size != map.cell_size()) {
    return Fail("the map without these objects has voxels of " +
                std::to_string(overlay.voxel_size) + " m, expected " +
                std::to_string(map.cell_size()) + " m");
  }
  OccupancyMap copy(map.cell_size());
  if (region) {
    for (const BlockIndex& index : BlocksIn(map.blocks(), *region)) copy.Set(index, map.At(index));
  } else {
    map.blocks().ForEach(
        [&](BlockIndex index, const BlockOccupancy& occupancy) { copy.Set(index, occupancy); });
  }
  LayOver(overlay, region, &copy);
  return copy;
}

}  // namespace vismap
