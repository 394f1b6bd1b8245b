#pragma once

#include <cstdint>
#include <string>
#include <vismap/octree_t.hpp>

#include "freespace/octree.h"

namespace vismap {

/// An octree and the map that it was made of, as OCTOMAP carries it.
struct OctreeMessage {
  int64_t utime = 0;  ///< of the newest frame contained [us]
  std::string map_id;
  int64_t revision = 0;
  double voxel_size = 0;  ///< of the map [m]
  OccupancyOptions rule;  ///< that told free from occupied
  OctreeBytes octree;     ///< a .bt stream
};

octree_t Encode(const OctreeMessage& octree);

/// Fails, naming the field, on another encoding than .bt, on a stream that is no octree, and on a
/// resolution or number of nodes that is not the stream's.
Result<OctreeMessage> Decode(const octree_t& message);

}  // namespace vismap
