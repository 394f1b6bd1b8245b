#pragma once

#include <algorithm>
#include <cstdint>

#include "freespace/occupancy_map.h"

namespace vismap {

// OctoMap's key space has 2^16 leaves along each axis, with the origin in the middle. A block of
// 8^3 leaves is a node three levels above the leaves. All coordinates in this file are in leaves.

/// Levels from a block up to the root.
inline constexpr int kOctreeBlockLevels = 13;
/// Half the edge of the key space [blocks].
inline constexpr int32_t kOctreeBlockOffset = 1 << (kOctreeBlockLevels - 1);
/// Half the edge of the key space [leaves].
inline constexpr int32_t kOctreeCellOffset = kBlockSide * kOctreeBlockOffset;

/// The cube of leaves that a node of the octree covers.
struct OctreeCube {
  VoxelIndex min;
  int32_t size = 0;  ///< leaves along an edge, a power of two

  static OctreeCube Everything() {
    return {{-kOctreeCellOffset, -kOctreeCellOffset, -kOctreeCellOffset}, 2 * kOctreeCellOffset};
  }
  /// One of the eight children, in OctoMap's order: x fastest.
  OctreeCube Child(int child) const {
    const int32_t half = size / 2;
    return {{min.x + (child & 1) * half, min.y + ((child >> 1) & 1) * half,
             min.z + ((child >> 2) & 1) * half},
            half};
  }
  OccupancyBox Box() const { return {min, {min.x + size, min.y + size, min.z + size}}; }
};

/// The cells in both boxes; OccupancyBox{} when there are none.
inline OccupancyBox Intersect(const OccupancyBox& a, const OccupancyBox& b) {
  const OccupancyBox both{
      {std::max(a.min.x, b.min.x), std::max(a.min.y, b.min.y), std::max(a.min.z, b.min.z)},
      {std::min(a.max.x, b.max.x), std::min(a.max.y, b.max.y), std::min(a.max.z, b.max.z)}};
  const bool none =
      both.min.x >= both.max.x || both.min.y >= both.max.y || both.min.z >= both.max.z;
  return none ? OccupancyBox{} : both;
}

/// The space that a tree describes.
struct OctreeExtent {
  OccupancyBox box;    ///< where leaves are as in the map
  OccupancyBox outer;  ///< contains `box`; in a closed tree, leaves outside of `box` are occupied
  friend bool operator==(const OctreeExtent&, const OctreeExtent&) = default;
};

inline bool Disjoint(const OctreeCube& cube, const OccupancyBox& box) {
  return Intersect(cube.Box(), box) == OccupancyBox{};
}

inline bool Inside(const OctreeCube& cube, const OccupancyBox& box) {
  return Intersect(cube.Box(), box) == cube.Box();
}

/// Calls visit(offset) with the offset in its block of each leaf of a cube that is smaller than a
/// block.
template <typename Visit>
void ForEachOffset(const OctreeCube& cube, const Visit& visit) {
  for (int z = cube.min.z; z < cube.min.z + cube.size; ++z) {
    for (int y = cube.min.y; y < cube.min.y + cube.size; ++y) {
      for (int x = cube.min.x; x < cube.min.x + cube.size; ++x)
        visit(static_cast<size_t>(OffsetInBlock(VoxelIndex{x, y, z})));
    }
  }
}

/// Calls visit(index) for each block of a cube of whole blocks until it returns false, and returns
/// whether it never did.
template <typename Visit>
bool ForEachBlock(const OctreeCube& cube, const Visit& visit) {
  const BlockIndex first = BlockOf(cube.min);
  const int32_t side = cube.size / kBlockSide;
  for (int32_t z = 0; z < side; ++z) {
    for (int32_t y = 0; y < side; ++y) {
      for (int32_t x = 0; x < side; ++x)
        if (!visit(BlockIndex{first.x + x, first.y + y, first.z + z})) return false;
    }
  }
  return true;
}

}  // namespace vismap
