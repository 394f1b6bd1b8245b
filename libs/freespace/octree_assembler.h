#pragma once

#include <span>

#include "freespace/octree_nodes.h"

namespace vismap {

/// Levels from a block up to the cubes whose bytes are kept, and what that is in leaves. Smaller
/// cubes are less to write again, larger ones fewer to copy together: 2 measured best on an office.
inline constexpr int kOctreeCubeLevels = 2;
inline constexpr int32_t kOctreeCubeSide = kBlockSide << kOctreeCubeLevels;

/// Place of a cube of kOctreeCubeSide leaves in depth-first order.
uint64_t OctreeOrder(const OctreeCube& cube);

struct PlacedSubtree {
  uint64_t order = 0;                ///< of its cube
  const Subtree* subtree = nullptr;  ///< written for the part of the cube within the bounds
};

/// A whole tree within `box`, put together of the cubes of which anything is known, in ascending
/// order.
NodeWriter AssembleOctree(std::span<const PlacedSubtree> parts, const OccupancyBox& box,
                          UnknownPolicy unknown);

}  // namespace vismap
