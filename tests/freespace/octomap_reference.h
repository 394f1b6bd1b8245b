#pragma once

#include <octomap/octomap.h>

#include <sstream>
#include <string>

#include "freespace/octree.h"

namespace vismap::testing_support {

inline bool Contains(const OccupancyBox& box, int x, int y, int z) {
  return x >= box.min.x && x < box.max.x && y >= box.min.y && y < box.max.y && z >= box.min.z &&
         z < box.max.z;
}

/// The octree as OctoMap makes it: every cell is set, then pruned and written by OctoMap. What lies
/// within `outer` and not within `box` is occupied.
inline std::string OctomapBytes(const OccupancyMap& leaves, double resolution,
                                UnknownPolicy unknown, const OccupancyBox& box,
                                const OccupancyBox& outer) {
  octomap::OcTree tree(resolution);
  for (int z = outer.min.z; z < outer.max.z; ++z) {
    for (int y = outer.min.y; y < outer.max.y; ++y) {
      for (int x = outer.min.x; x < outer.max.x; ++x) {
        CellState state =
            Contains(box, x, y, z) ? leaves.At(VoxelIndex{x, y, z}) : CellState::kOccupied;
        if (state == CellState::kUnknown) {
          if (unknown == UnknownPolicy::kAbsent) continue;
          state = CellState::kOccupied;
        }
        const octomap::OcTreeKey key(static_cast<octomap::key_type>(x + 32768),
                                     static_cast<octomap::key_type>(y + 32768),
                                     static_cast<octomap::key_type>(z + 32768));
        tree.setNodeValue(key, state == CellState::kOccupied ? 3.5F : -2.0F, true);
      }
    }
  }
  tree.updateInnerOccupancy();
  tree.prune();
  std::ostringstream bytes;
  tree.writeBinary(bytes);
  return bytes.str();
}

inline std::string OctomapBytes(const OccupancyMap& leaves, double resolution,
                                UnknownPolicy unknown, const OccupancyBox& box) {
  return OctomapBytes(leaves, resolution, unknown, box, box);
}

inline std::string Text(const std::vector<uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace vismap::testing_support
