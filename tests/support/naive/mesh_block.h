#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "meshing/marching_cubes.h"

namespace vismap::naive {

/// Corners in W [m], counter-clockwise seen from free space.
using Triangle = std::array<std::array<float, 3>, 3>;

/// Signed distance of a voxel in steps of truncation / kTruncationSteps; nullopt = not observed
/// well enough.
std::optional<int> SeenDistance(const VoxelMap& map, VoxelIndex voxel,
                                const MeshingOptions& options);

/// The surface in the cells of one block, cell by cell, each voxel looked up in the map: the same
/// triangles as in the fast mesh, bit for bit; sorted, each from its lowest corner on. Normals,
/// colours and labels are not its business.
std::vector<Triangle> MeshBlock(const SemanticMap& map, BlockIndex block,
                                const MeshingOptions& options);

/// The triangles of a mesh in the same order.
std::vector<Triangle> SortedTriangles(const Mesh& mesh);

}  // namespace vismap::naive
