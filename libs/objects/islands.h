#pragma once

#include "meshing/marching_cubes.h"

namespace vismap {

/// Reassigns islands: small pieces of an object that lie within the surface of something else. They
/// come from masks that reach past the object onto the wall behind it, and from votes that no later
/// frame corrected. Without this step, they would count as parts of the object.
///
/// The owner of a vertex is its instance, or its segment if it has no instance. A piece is a
/// connected part of the mesh with one owner. A piece is an island if all of these hold:
///  - its area is below island_max_area_m2 and below island_max_share of the area of its owner;
///  - at least 3/4 of the mesh edges across its border lead to one and the same other owner;
///  - the border to that owner is at least half as long as the rim of a disc with as many vertices,
///    and the surface on both sides faces the same way (the mean normals' dot product is at least
///    0.7). So an object that stands on the surface, or that ends at unobserved space, is not an
///    island. This test is skipped if all pieces of the owner are as small as the first test asks.
/// The vertices of an island get the segment that most edges across its border lead to, of the
/// surrounding owner's segments. Vertices without a segment do not change. `mesh` must have its
/// instances read out. Only `segment` changes: read out instances and classes again afterwards.
void AbsorbIslands(const MeshingOptions& options, Mesh* mesh);

}  // namespace vismap
