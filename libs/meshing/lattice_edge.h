#pragma once

#include "volume/block.h"

namespace vismap {

/// An edge of the voxel lattice: from voxel (x, y, z), local to a block, 0..8, to the next one
/// along `axis` (0 = x, 1 = y, 2 = z).
struct LatticeEdge {
  int x = 0, y = 0, z = 0;
  int axis = 0;
};

/// Numbers the edges of a block's cells.
inline constexpr int kSlotSide = kBlockSide + 1;
inline constexpr int kEdgeSlots = kSlotSide * kSlotSide * kSlotSide * 3;
constexpr int EdgeSlot(const LatticeEdge& e) {
  return e.axis + 3 * (e.x + kSlotSide * (e.y + kSlotSide * e.z));
}
constexpr LatticeEdge EdgeOfSlot(int slot) {
  return {slot / 3 % kSlotSide, slot / (3 * kSlotSide) % kSlotSide,
          slot / (3 * kSlotSide * kSlotSide), slot % 3};
}

}  // namespace vismap
