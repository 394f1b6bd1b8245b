#pragma once

#include <span>

#include "freespace/octree_nodes.h"

namespace vismap {

/// Levels from a block up to the cubes whose bytes are kept. After a change, small cubes need less
/// encoding, and large ones less copying; 2 measured best on an office.
inline constexpr int kOctreeCubeLevels = 2;
/// Edge of these cubes [leaves].
inline constexpr int32_t kOctreeCubeSide = kBlockSide << kOctreeCubeLevels;

/// Position of a cube of kOctreeCubeSide leaves in depth-first order.
uint64_t OctreeOrder(const OctreeCube& cube);

/// The subtree of a cube.
struct PlacedSubtree {
  uint64_t order = 0;                ///< see OctreeOrder
  const Subtree* subtree = nullptr;  ///< encoded for the part of the cube within the bounds
};

/// A whole tree within `outer`, assembled from the subtrees of all cubes that are not unknown
/// everywhere, in ascending order. All other space within `outer` is unknown.
NodeWriter AssembleOctree(std::span<const PlacedSubtree> parts, const OccupancyBox& outer,
                          UnknownPolicy unknown);

}  // namespace vismap
