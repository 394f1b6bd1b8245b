#include "freespace/slice.h"

#include <algorithm>
#include <cmath>

namespace vismap {

OccupancySlice SliceAt(const OccupancyMap& map, double z) {
  const double size = map.cell_size();
  const auto layer = static_cast<int32_t>(std::clamp(std::floor(z / size), -1e9, 1e9));
  OccupancySlice slice;
  slice.cell_size = size;
  slice.z_min = layer * size;
  slice.z_max = (layer + 1) * size;
  const std::optional<OccupancyBox> box = map.KnownCells();
  if (!box) return slice;
  slice.origin_W = Eigen::Vector2d(box->min.x, box->min.y) * size;
  slice.states = Image<CellState>(box->max.x - box->min.x, box->max.y - box->min.y);
  map.blocks().ForEach([&](BlockIndex index, const BlockOccupancy& block) {
    if (index.z != layer >> 3) return;
    for (int y = 0; y < kBlockSide; ++y) {
      for (int x = 0; x < kBlockSide; ++x) {
        const int v = kBlockSide * index.y + y - box->min.y;
        const int u = kBlockSide * index.x + x - box->min.x;
        if (slice.states.Contains(v, u)) {
          slice.states(v, u) = block.At(LinearIndex(x, y, layer & 7));
        }
      }
    }
  });
  return slice;
}

}  // namespace vismap
