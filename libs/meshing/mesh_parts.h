#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "meshing/mesh.h"

namespace vismap {

/// Per vertex the number of its connected component: 0, 1, ... in the order of their first
/// vertices. The vertices of a triangle are connected.
std::vector<uint32_t> ConnectedComponents(const Mesh& mesh);

/// The same, but an edge connects vertices a and b only if `joins(a, b)`.
std::vector<uint32_t> ConnectedComponents(const Mesh& mesh,
                                          const std::function<bool(uint32_t, uint32_t)>& joins);

/// The triangles i with keep[i] != 0 and the vertices that they use, both in the old order.
Mesh KeepTriangles(const Mesh& mesh, const std::vector<uint8_t>& keep);

/// Drops connected components with fewer than `min_triangles` triangles, and unused vertices.
Mesh RemoveSmallComponents(const Mesh& mesh, int min_triangles);

/// Area of triangle i [m^2].
double TriangleArea(const Mesh& mesh, size_t i);

}  // namespace vismap
