#pragma once

#include <cstdint>
#include <vismap/octree_delta_t.hpp>

#include "base/result.h"
#include "wire/map_update.h"

namespace vismap {

/// The content of one OCTOMAP_DELTA.
struct OctreeUpdate {
  MapUpdate leaves;             ///< its cells are leaves
  int64_t published_utime = 0;  ///< when it was sent [us]
  double voxel_size = 0;        ///< of the map [m]
  double shell = 0;             ///< of the closed tree on OCTOMAP, see OctreeOptions [m]
};

octree_delta_t Encode(const OctreeUpdate& update);

/// Fails, naming the field, on every value that Encode does not produce.
Result<OctreeUpdate> Decode(const octree_delta_t& message);

}  // namespace vismap
