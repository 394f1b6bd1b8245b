#pragma once

#include "meshing/cell_grid.h"

namespace vismap {

/// An edge of the voxel lattice: from voxel (x, y, z), local to a block, to the next one along
/// `axis` (0 = x, 1 = y, 2 = z).
struct LatticeEdge {
  int x = 0, y = 0, z = 0;
  int axis = 0;
};

/// The vertex where the surface crosses an edge: position linear between the two voxels (kept 1 %
/// off them, so that no triangle collapses), normal from the interpolated gradient, colour
/// interpolated, and the label of the nearest voxel that has votes: of the two ends, else the most
/// frequent one among the voxels next to them (ties to the lower label). It depends on the voxels
/// around the edge only, so every block that has the edge makes the same vertex. Instance and class
/// are left to the caller.
MeshVertex MakeSurfaceVertex(const CellGrid& grid, const LatticeEdge& edge, double voxel_size,
                             const LabelTable& labels);

}  // namespace vismap
