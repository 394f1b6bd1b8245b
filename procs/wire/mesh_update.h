#pragma once

#include <cstdint>
#include <string>
#include <vector>
#include <vismap/mesh_block_t.hpp>
#include <vismap/mesh_delta_t.hpp>

#include "base/result.h"
#include "meshing/marching_cubes.h"

namespace vismap {

/// The content of one MESH_DELTA: the surface of the blocks that changed between two revisions of a
/// map, or of all blocks.
struct MeshUpdate {
  int64_t utime = 0;           ///< of the newest frame contained [us]
  std::string map_id;          ///< a reset and a load change it
  int64_t base_revision = -1;  ///< revision that the receiver must have; -1 = full mesh
  bool full = false;  ///< the update has the whole surface: blocks that are in no part are deleted
  int32_t part = 0;   ///< index of this part, 0 to parts - 1
  int32_t parts = 1;
  double block_size = 0;  ///< edge of a block [m]
  MeshDelta mesh;
};

/// Rounds positions to 1/65535 of two block edges, and components of normals to 1/127.
mesh_delta_t Encode(const MeshUpdate& update);

/// Decodes the surface of one block. Fails, naming the block, on vertex indices out of range.
Result<BlockMesh> Decode(const mesh_block_t& message);
/// Checks a message without decoding it. Fails, naming the block, on vertex indices out of range
/// and on blocks that are not in ascending order.
Result<void> Check(const mesh_delta_t& message);
/// Checks and decodes a message.
Result<MeshUpdate> Decode(const mesh_delta_t& message);

}  // namespace vismap
