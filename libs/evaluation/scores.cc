#include "evaluation/scores.h"

#include <algorithm>
#include <cmath>

namespace vismap {
namespace {

// Whether a whole block is in true free space. Then its cells, as those of most blocks, need not be
// checked one by one.
bool IsFarFromSurface(const OccupancyMap& map, BlockIndex index, const TrueDistance& truth) {
  const double side = kBlockSide * map.cell_size();
  const Eigen::Vector3d center = (Eigen::Vector3d(index.x, index.y, index.z).array() + 0.5) * side;
  return truth(center) > 0.5 * std::sqrt(3.0) * side;
}

}  // namespace

FreeSpaceScore ScoreFreeSpace(const OccupancyMap& map, const TrueDistance& truth, double margin) {
  FreeSpaceScore score;
  for (const BlockIndex& index : map.SortedIndices()) {
    const BlockOccupancy& block = map.At(index);
    if (block.is(CellState::kFree) && IsFarFromSurface(map, index, truth)) {
      score.free_cells += kBlockVoxels;
      continue;
    }
    for (int offset = 0; offset < kBlockVoxels; ++offset) {
      const CellState state = block.At(offset);
      if (state == CellState::kUnknown) continue;  // never wrong
      const Eigen::Vector3d cell(index.x * kBlockSide + offset % kBlockSide,
                                 index.y * kBlockSide + offset / kBlockSide % kBlockSide,
                                 index.z * kBlockSide + offset / (kBlockSide * kBlockSide));
      const double distance = truth((cell.array() + 0.5) * map.cell_size());
      ++(state == CellState::kFree ? score.free_cells : score.occupied_cells);
      if (state == CellState::kFree && distance < -margin) ++score.free_but_solid;
      if (state == CellState::kFree) score.deepest_free = std::max(score.deepest_free, -distance);
      if (state == CellState::kOccupied && distance > margin) ++score.occupied_but_free;
    }
  }
  return score;
}

}  // namespace vismap
