#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "map/block.h"

namespace vismap {

/// The mesh of a block's cells depends on its own voxels and on a rim of voxels around the block:
/// this many below and above it along each axis.
inline constexpr int kRimBelow = 1, kRimAbove = 2;

/// A set out of a block and the 26 around it: bit NeighbourSlot of each.
using NeighbourBits = uint32_t;
inline constexpr size_t kNeighbourSlots = 27;
inline constexpr NeighbourBits kAllNeighbours = (NeighbourBits{1} << kNeighbourSlots) - 1;
/// The bit of the neighbour at (x, y, z), each -1..1.
constexpr size_t NeighbourSlot(int x, int y, int z) {
  return static_cast<size_t>((z + 1) + 3 * ((y + 1) + 3 * (x + 1)));
}

/// The blocks whose mesh depends on any of these voxels of a block: the block itself, and those
/// around it that have such a voxel in their rim. None if `voxels` is empty.
NeighbourBits AffectedBy(const VoxelBits& voxels);

/// Blocks that changed.
struct BlockChanges {
  /// Any voxel of these blocks may have changed; in any order.
  BlockChanges(std::span<const BlockIndex> changed) : blocks(changed) {}
  BlockChanges(const std::vector<BlockIndex>& changed) : blocks(changed) {}
  /// `changed` ascending; `affected_by_each` = AffectedBy of the changed voxels of each.
  BlockChanges(std::span<const BlockIndex> changed, std::span<const NeighbourBits> affected_by_each)
      : blocks(changed), affected(affected_by_each) {}

  std::span<const BlockIndex> blocks;
  std::span<const NeighbourBits> affected;  ///< empty = all 27 blocks around each
};

}  // namespace vismap
