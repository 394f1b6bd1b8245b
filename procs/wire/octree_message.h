#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/octree_t.hpp>

#include "freespace/octree.h"

namespace vismap {

/// The content of one OCTOMAP message: an octree, and the map from which it was computed.
struct OctreeMessage {
  int64_t utime = 0;            ///< of the newest frame contained [us]
  int64_t published_utime = 0;  ///< when it was sent [us]
  std::string map_id;
  int64_t revision = 0;
  double voxel_size = 0;   ///< of the map [m]
  OccupancyOptions rule;   ///< with which voxels were classified as free or occupied
  OctreeBytes octree;      ///< a .bt stream
  double inflated_by = 0;  ///< see octree_t.inflated_by_m [m]
  /// Leaves that are free though they were never seen, see octree_t.assumed_free_x.
  std::vector<VoxelIndex> assumed_free;
};

octree_t Encode(const OctreeMessage& octree);

/// Fails, naming the field, on an encoding other than .bt, on a stream that is not an octree, on a
/// resolution or number of nodes that differs from the stream, and on lengths that are negative or
/// above 1000 m.
Result<OctreeMessage> Decode(const octree_t& message);

}  // namespace vismap
