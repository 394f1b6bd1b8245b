#pragma once

#include "meshing/marching_cubes.h"

namespace vismap {

/// The mesh of a whole map as people get it: its surface (ExtractSurface) with instances and
/// classes read out. The class of an instance is the one with most evidence over its labels,
/// weighted by their vertices. Islands and contacts are then given to what they belong to, see
/// AbsorbIslands and AbsorbContacts.
Mesh ExtractMesh(const SemanticMap& map, const MeshingOptions& options = {});

}  // namespace vismap
