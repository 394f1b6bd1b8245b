#pragma once

#include "meshing/marching_cubes.h"

namespace vismap {

/// The mesh of a whole map as users get it: the surface (ExtractSurface) with the instance and the
/// class of every vertex, after AbsorbIslands and AbsorbContacts have corrected the segments. The
/// class of an instance is the one with the most evidence, summed over the labels of the instance
/// and weighted by their numbers of vertices. Positions in W [m].
Mesh ExtractMesh(const SemanticMap& map, const MeshingOptions& options = {});

}  // namespace vismap
