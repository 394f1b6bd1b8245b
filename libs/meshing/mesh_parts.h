#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "meshing/mesh.h"

namespace vismap {

/// For every vertex, the number of its connected component (0, 1, ... by first vertex). Vertices
/// are connected through shared triangles.
std::vector<uint32_t> ConnectedComponents(const Mesh& mesh);

/// The same, where an edge connects vertices a and b only if `joins(a, b)`.
std::vector<uint32_t> ConnectedComponents(const Mesh& mesh,
                                          const std::function<bool(uint32_t, uint32_t)>& joins);

/// The mesh of the triangles with keep[i] != 0 and only the vertices that they use, both in the
/// old order.
Mesh KeepTriangles(const Mesh& mesh, const std::vector<uint8_t>& keep);

/// Drops connected components with fewer than `min_triangles` triangles, and unused vertices.
Mesh RemoveSmallComponents(const Mesh& mesh, int min_triangles);

/// Area of triangle i [m^2].
double TriangleArea(const Mesh& mesh, size_t i);

}  // namespace vismap
