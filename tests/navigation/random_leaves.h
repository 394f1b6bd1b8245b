#pragma once

#include <vector>

#include "freespace/random_occupancy.h"

namespace vismap::testing_support {

/// Like the leaves of a real map: mostly free blocks with a few occupied or unknown leaves, and
/// blocks that are missing. `half` blocks to either side of the origin.
inline BlockOccupancy RandomLeafBlock(Random* random) {
  const int kind = random->Below(10);
  if (kind == 0) return BlockOccupancy(CellState::kUnknown);
  if (kind == 1) return RandomBlock(random);
  OccupancyPlanes planes = BlockOccupancy(CellState::kFree).Planes();
  const int changed = kind < 6 ? 0 : random->Below(4);
  for (int i = 0; i < changed; ++i) {
    const auto layer = static_cast<size_t>(random->Below(8));
    const uint64_t bit = uint64_t{1} << random->Below(64);
    planes.free[layer] &= ~bit;
    if (random->Below(3) > 0) planes.occupied[layer] |= bit;
  }
  return BlockOccupancy(planes);
}

inline BlockIndex RandomBlockIndex(Random* random, int half) {
  return {random->Below(2 * half + 1) - half, random->Below(2 * half + 1) - half,
          random->Below(2 * half) - half};
}

inline OccupancyMap RandomLeaves(uint64_t seed, int half, double leaf_m = 0.05) {
  Random random(seed);
  OccupancyMap leaves(leaf_m);
  for (int z = -half; z < half; ++z) {
    for (int y = -half; y <= half; ++y) {
      for (int x = -half; x <= half; ++x) leaves.Set({x, y, z}, RandomLeafBlock(&random));
    }
  }
  return leaves;
}

/// Changes a few leaves, or whole blocks, and returns the blocks that it touched.
inline std::vector<BlockIndex> ChangeLeaves(Random* random, int half, OccupancyMap* leaves) {
  std::vector<BlockIndex> changed;
  const int count = 1 + random->Below(5);
  for (int i = 0; i < count; ++i) {
    changed.push_back(RandomBlockIndex(random, half));
    OccupancyPlanes planes = leaves->At(changed.back()).Planes();
    const auto layer = static_cast<size_t>(random->Below(8));
    const uint64_t bit = uint64_t{1} << random->Below(64);
    planes.free[layer] &= ~bit;
    planes.occupied[layer] ^= bit;
    const bool whole = random->Below(3) == 0;
    leaves->Set(changed.back(), whole ? RandomLeafBlock(random) : BlockOccupancy(planes));
  }
  return changed;
}

}  // namespace vismap::testing_support
