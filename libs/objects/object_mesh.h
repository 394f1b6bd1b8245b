#pragma once

#include <span>
#include <string>
#include <vector>

#include "objects/objects.h"

namespace vismap {

/// Cuts the mesh of the whole map into one mesh per object, in the order of `objects`. A triangle
/// goes to the object that has at least two of its corners, or, if all three differ, to that of its
/// first corner. So the parts fit together without gaps. Triangles that belong to none of the
/// objects are left out, and the meshes of removed objects are empty.
std::vector<Mesh> CutObjects(const Mesh& mesh, std::span<const ObjectSummary> objects);

/// Name of an object in files and tables: "instance_7_chair" or "segment_12". It has only letters,
/// digits, '-' and '_'. `class_name` may be empty.
std::string ObjectFileName(const ObjectSummary& object, const std::string& class_name);

}  // namespace vismap
