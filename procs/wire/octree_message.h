#pragma once

#include <cstdint>
#include <string>
#include <vismap/octree_t.hpp>

#include "freespace/octree.h"

namespace vismap {

/// The content of one OCTOMAP message: an octree, and the map from which it was computed.
struct OctreeMessage {
  int64_t utime = 0;  ///< of the newest frame contained [us]
  std::string map_id;
  int64_t revision = 0;
  double voxel_size = 0;  ///< of the map [m]
  OccupancyOptions rule;  ///< with which voxels were classified as free or occupied
  OctreeBytes octree;     ///< a .bt stream
};

octree_t Encode(const OctreeMessage& octree);

/// Fails, naming the field, on an encoding other than .bt, on a stream that is not an octree, and
/// on a resolution or number of nodes that differs from the stream.
Result<OctreeMessage> Decode(const octree_t& message);

}  // namespace vismap
