#pragma once

#include <span>
#include <vector>

#include "meshing/marching_cubes.h"

namespace vismap::testing_support {

/// Meshes the blocks whose surface may differ after some changes, ascending. `shown`: what each
/// label shows.
inline std::vector<BlockMesh> MeshBlocks(const SemanticMap& map, const BlockChanges& changes,
                                         std::span<const ShownLabel> shown,
                                         const MeshingOptions& options = {}) {
  return MeshEachBlock(map, BlocksToMesh(map.voxels, changes), shown, options);
}

}  // namespace vismap::testing_support
