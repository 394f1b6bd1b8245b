#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/mesh_block_t.hpp>
#include <vismap/mesh_delta_t.hpp>

#include "base/result.h"
#include "meshing/marching_cubes.h"

namespace vismap {

/// Surface that changed between two revisions of a map, or all of it, as MESH_DELTA carries it.
struct MeshUpdate {
  int64_t utime = 0;           ///< of the newest frame contained [us]
  std::string map_id;          ///< changes on reset and load
  int64_t base_revision = -1;  ///< what the receiver must have; -1 with a full mesh
  bool full = false;           ///< part of everything: forget blocks that no part names
  int32_t part = 0;
  int32_t parts = 1;
  double block_size = 0;  ///< edge of a block [m]
  MeshDelta mesh;
};

/// Positions are kept to 1/65535 of two block edges, normals to 1/127.
mesh_delta_t Encode(const MeshUpdate& update);

/// The surface of one block. Fails, naming it, on indices out of range.
Result<BlockMesh> Decode(const mesh_block_t& message);
/// Fails, naming the block, on indices out of range and on blocks out of order.
Result<void> Check(const mesh_delta_t& message);
/// The same, with its content.
Result<MeshUpdate> Decode(const mesh_delta_t& message);

}  // namespace vismap
