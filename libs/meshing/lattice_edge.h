#pragma once

#include <cstddef>
#include <cstdint>

#include "map/block.h"

namespace vismap {

/// An edge of the voxel lattice: from voxel (x, y, z), local to a block, 0..8, to the next one
/// along `axis` (0 = x, 1 = y, 2 = z).
struct LatticeEdge {
  int x = 0, y = 0, z = 0;
  int axis = 0;
};

/// The slot of an edge of a block's cells: four bits per coordinate and two for the axis. A step
/// along an axis adds the same number to every slot, and 16 slots along x are one row of bits (see
/// CrossEdges).
inline constexpr int kSlotSide = kBlockSide + 1;
inline constexpr int kSlotBits = 4;
inline constexpr int kSlotStride = 1 << kSlotBits;
inline constexpr int kAxisSlots = 1 << (3 * kSlotBits);
inline constexpr int kEdgeSlots = 3 * kAxisSlots;
constexpr int EdgeSlot(const LatticeEdge& e) {
  return e.x | e.y << kSlotBits | e.z << (2 * kSlotBits) | e.axis << (3 * kSlotBits);
}
constexpr LatticeEdge EdgeOfSlot(int slot) {
  constexpr int kMask = kSlotStride - 1;
  return {slot & kMask, slot >> kSlotBits & kMask, slot >> (2 * kSlotBits) & kMask,
          slot >> (3 * kSlotBits)};
}
/// The difference of slots for one step along an axis.
constexpr size_t AxisStep(size_t axis) { return size_t{1} << (kSlotBits * axis); }

}  // namespace vismap
