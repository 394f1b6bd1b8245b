#pragma once

#include <octomap/octomap.h>

#include <sstream>
#include <string>

#include "freespace/octree.h"

namespace vismap::testing_support {

/// The octree as OctoMap makes it: every cell is set, then pruned and written by OctoMap.
inline std::string OctomapBytes(const OccupancyMap& leaves, double resolution,
                                UnknownPolicy unknown, const OccupancyBox& box) {
  octomap::OcTree tree(resolution);
  for (int z = box.min.z; z < box.max.z; ++z) {
    for (int y = box.min.y; y < box.max.y; ++y) {
      for (int x = box.min.x; x < box.max.x; ++x) {
        CellState state = leaves.At(VoxelIndex{x, y, z});
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

inline std::string Text(const std::vector<uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace vismap::testing_support
