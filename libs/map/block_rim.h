#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "map/block.h"

namespace vismap {

/// The surface of a block's cells depends on its own voxels and on a rim of others around them, so
/// many along each axis.
inline constexpr int kRimBelow = 1, kRimAbove = 2;

/// A set of the 27 blocks around a block, with itself: bit NeighbourSlot.
using NeighbourBits = uint32_t;
inline constexpr size_t kNeighbourSlots = 27;
inline constexpr NeighbourBits kAllNeighbours = (NeighbourBits{1} << kNeighbourSlots) - 1;
/// Of the neighbour at (x, y, z), each -1..1.
constexpr size_t NeighbourSlot(int x, int y, int z) {
  return static_cast<size_t>((z + 1) + 3 * ((y + 1) + 3 * (x + 1)));
}

/// The blocks whose surface depends on some voxels of a block: itself, and those around it that
/// have one of them in their rim. None without voxels.
NeighbourBits AffectedBy(const VoxelBits& voxels);

/// Blocks that changed.
struct BlockChanges {
  /// Wholly, in any order.
  BlockChanges(std::span<const BlockIndex> changed) : blocks(changed) {}
  BlockChanges(const std::vector<BlockIndex>& changed) : blocks(changed) {}
  /// `changed` ascending; `affected_by_each` = AffectedBy of what changed in each.
  BlockChanges(std::span<const BlockIndex> changed, std::span<const NeighbourBits> affected_by_each)
      : blocks(changed), affected(affected_by_each) {}

  std::span<const BlockIndex> blocks;
  std::span<const NeighbourBits> affected;  ///< none = everything around each
};

}  // namespace vismap
