#pragma once

#include "meshing/mesh.h"

namespace vismap {

/// Gives the rim of what stands on structure, or against it, to the structure. Where a leg meets
/// the floor the surface is one, and the votes of the two are a voxel or two apart: an object would
/// take a ring of floor with it, and whoever drives there would find the object's name under its
/// wheels.
///
/// Structure is a segment outside of all instances that is as large and as flat as StructureOptions
/// asks for. Every vertex of something else that shares an edge with it, and is no farther than
/// `distance` from its plane [m], then has that segment; of several the closest, ties to the lower.
/// But what rises less than 10 cm from that plane, a book or a rug, keeps its rim, which is a good
/// part of it. Instances and classes must be read out again afterwards.
void AbsorbContacts(double distance, Mesh* mesh);

}  // namespace vismap
