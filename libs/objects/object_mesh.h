#pragma once

#include <span>
#include <string>
#include <vector>

#include "objects/objects.h"

namespace vismap {

/// The mesh of each object, cut out of the mesh of the whole map: a triangle goes to the object
/// that most of its corners belong to (all three different: the one of its first corner), so that
/// the pieces of all objects and of the rest fit together without gaps. Triangles of nobody in
/// `objects` are left out, as is what remains of removed ones (their meshes are empty).
std::vector<Mesh> CutObjects(const Mesh& mesh, std::span<const ObjectSummary> objects);

/// Name of an object in files and tables: "instance_7_chair", "segment_12". Letters, digits,
/// '-' and '_' only; `class_name` may be empty.
std::string ObjectFileName(const ObjectSummary& object, const std::string& class_name);

}  // namespace vismap
