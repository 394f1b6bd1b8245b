#pragma once

#include "meshing/mesh.h"

namespace vismap {

/// Assigns the vertices where an object touches a floor or a wall to that floor or wall. The
/// surfaces of the two are connected there, and the border between their votes is off by a voxel or
/// two. Without this step, an object includes a ring of the floor that it stands on.
///
/// A structure plane is a segment outside of all instances with the area and the planar share that
/// StructureOptions asks for. A vertex of any other segment gets the label of the structure plane
/// if it shares a mesh edge with a vertex of that plane and is within `distance` [m] of the plane.
/// If several planes qualify, the nearest one wins, then the lower label. An object that rises less
/// than 10 cm above the plane, such as a book or a rug, keeps its vertices, because its border is a
/// large part of it. Only `segment` changes: read out instances and classes again afterwards.
void AbsorbContacts(double distance, Mesh* mesh);

}  // namespace vismap
