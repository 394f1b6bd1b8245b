#pragma once

#include "meshing/marching_cubes.h"

namespace vismap {

/// Gives islands to what they lie in. A mask that reaches past an object, and votes that a later
/// frame never took back, leave shreds of it on the wall behind it: they would be a part of the
/// object, and all that is left of one that never was.
///
/// Surface is of one piece where triangles join vertices of one instance, or, outside of all
/// instances, of one segment. An island is a piece with less than island_max_share of the surface
/// of its instance or segment and smaller than island_max_area, three quarters of whose borders are
/// with a single other one. That border must be as long as half the rim of a disc of its size and
/// the island flush with what is beyond it (so what stands on a surface, or ends where nothing was
/// seen, is none), unless all of its instance or segment is in such small pieces. Its vertices then
/// have the segment that most of the border has. `mesh` has its instances read out already, and
/// needs that again afterwards; pieces without any segment stay.
void AbsorbIslands(const MeshingOptions& options, Mesh* mesh);

}  // namespace vismap
