#pragma once

#include <cstdint>

#include "freespace/occupancy_map.h"

namespace vismap::testing_support {

/// Pseudo-random numbers that depend on the seed only.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  uint64_t Next() {
    uint64_t z = state_ += 0x9E3779B97F4A7C15ull;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return z ^ (z >> 31);
  }
  int Below(int bound) { return static_cast<int>(Next() % static_cast<uint64_t>(bound)); }

 private:
  uint64_t state_;
};

inline BlockOccupancy RandomBlock(Random* random) {
  const int kind = random->Below(6);
  if (kind < 2) return BlockOccupancy(CellState::kFree);
  if (kind == 2) return BlockOccupancy(CellState::kOccupied);
  OccupancyPlanes planes;
  for (size_t i = 0; i < planes.free.size(); ++i) {
    const uint64_t known = kind == 3 ? ~uint64_t{0} : random->Next() | random->Next();
    const uint64_t occupied = random->Next() & random->Next() & random->Next();
    planes.occupied[i] = known & occupied;
    planes.free[i] = known & ~occupied;
  }
  return BlockOccupancy(planes);
}

/// About `blocks` blocks in clusters, with positive and negative indices.
inline OccupancyMap RandomOccupancy(uint64_t seed, int blocks, double cell_size = 0.05) {
  Random random(seed);
  OccupancyMap map(cell_size);
  for (int i = 0; i < blocks; ++i) {
    const BlockIndex index{random.Below(9) - 4, random.Below(9) - 5, random.Below(5) - 2};
    map.Set(index, RandomBlock(&random));
  }
  return map;
}

}  // namespace vismap::testing_support
