#include "meshing/mesh_parts.h"

#include <Eigen/Geometry>
#include <limits>
#include <numeric>

namespace vismap {
namespace {

uint32_t Root(std::vector<uint32_t>& parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

// The lower root stays the root, so that the numbering does not depend on the order of the calls.
void Unite(std::vector<uint32_t>& parent, uint32_t a, uint32_t b) {
  a = Root(parent, a);
  b = Root(parent, b);
  if (a < b) parent[b] = a;
  if (b < a) parent[a] = b;
}

}  // namespace

std::vector<uint32_t> ConnectedComponents(const Mesh& mesh) {
  return ConnectedComponents(mesh, [](uint32_t, uint32_t) { return true; });
}

std::vector<uint32_t> ConnectedComponents(const Mesh& mesh,
                                          const std::function<bool(uint32_t, uint32_t)>& joins) {
  std::vector<uint32_t> parent(mesh.vertices.size());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto connect = [&](uint32_t a, uint32_t b) {
    if (joins(a, b)) Unite(parent, a, b);
  };
  for (const auto& [a, b, c] : mesh.triangles) {
    connect(a, b);
    connect(b, c);
    connect(c, a);
  }
  std::vector<uint32_t> component(parent.size());
  uint32_t count = 0;
  for (uint32_t i = 0; i < parent.size(); ++i) {
    const uint32_t root = Root(parent, i);
    component[i] = root == i ? count++ : component[root];
  }
  return component;
}

Mesh KeepTriangles(const Mesh& mesh, const std::vector<uint8_t>& keep) {
  constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> moved(mesh.vertices.size(), kUnused);
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (keep[i] == 0) continue;
    for (const uint32_t vertex : mesh.triangles[i]) moved[vertex] = 0;
  }
  Mesh kept;
  for (size_t i = 0; i < moved.size(); ++i) {
    if (moved[i] == kUnused) continue;
    moved[i] = static_cast<uint32_t>(kept.vertices.size());
    kept.vertices.push_back(mesh.vertices[i]);
  }
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (keep[i] == 0) continue;
    const auto& [a, b, c] = mesh.triangles[i];
    kept.triangles.push_back({moved[a], moved[b], moved[c]});
  }
  return kept;
}

Mesh RemoveSmallComponents(const Mesh& mesh, int min_triangles) {
  const std::vector<uint32_t> component = ConnectedComponents(mesh);
  std::vector<int> sizes(mesh.vertices.size(), 0);
  for (const auto& triangle : mesh.triangles) ++sizes[component[triangle[0]]];
  std::vector<uint8_t> keep(mesh.triangles.size());
  for (size_t i = 0; i < keep.size(); ++i) {
    keep[i] = sizes[component[mesh.triangles[i][0]]] >= min_triangles;
  }
  return KeepTriangles(mesh, keep);
}

double TriangleArea(const Mesh& mesh, size_t i) {
  const auto at = [&](size_t corner) -> Eigen::Vector3d {
    return mesh.vertices[mesh.triangles[i][corner]].position_W.cast<double>();
  };
  return 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
}

}  // namespace vismap
