#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include "meshing/mesh.h"

namespace vismap::testing_support {

/// How the edges of a mesh are used. A closed, consistently oriented surface has only `paired`.
struct EdgeUse {
  size_t paired = 0;       ///< in exactly two triangles, once in each direction
  size_t border = 0;       ///< in one triangle
  size_t nonmanifold = 0;  ///< anything else
};

inline EdgeUse CountEdges(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, std::pair<int, int>> uses;
  for (const auto& triangle : mesh.triangles) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      auto& use = uses[std::minmax(a, b)];
      (a < b ? use.first : use.second) += 1;
    }
  }
  EdgeUse count;
  for (const auto& [edge, use] : uses) {
    if (use == std::pair(1, 1)) {
      ++count.paired;
    } else if (use.first + use.second == 1) {
      ++count.border;
    } else {
      ++count.nonmanifold;
    }
  }
  return count;
}

/// Twice the area vector of triangle i: along its geometric normal.
inline Eigen::Vector3d FaceVector(const Mesh& mesh, size_t i) {
  const auto at = [&](size_t k) -> Eigen::Vector3d {
    return mesh.vertices[mesh.triangles[i][k]].position_W.cast<double>();
  };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

/// Volume enclosed by a closed mesh whose triangles are counter-clockwise seen from outside [m^3].
inline double EnclosedVolume(const Mesh& mesh) {
  double six_volumes = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](uint32_t i) -> Eigen::Vector3d {
      return mesh.vertices[i].position_W.cast<double>();
    };
    six_volumes += at(a).dot(at(b).cross(at(c)));
  }
  return six_volumes / 6;
}

/// The triangles as corner positions, each rotated to start at its smallest corner, sorted: equal
/// for meshes that are the same set of triangles, however they are indexed.
using TriangleSet = std::vector<std::array<std::array<float, 3>, 3>>;
inline void AppendTriangles(const Mesh& mesh, TriangleSet* set) {
  for (const auto& triangle : mesh.triangles) {
    std::array<std::array<float, 3>, 3> corners;
    for (size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f& p = mesh.vertices[triangle[i]].position_W;
      corners[i] = {p.x(), p.y(), p.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    set->push_back(corners);
  }
}

inline bool SameVertex(const MeshVertex& a, const MeshVertex& b) {
  return a.position_W == b.position_W && a.normal_W == b.normal_W && a.color == b.color &&
         a.segment == b.segment && a.instance == b.instance && a.class_id == b.class_id &&
         a.seen == b.seen;
}
inline bool SameMesh(const Mesh& a, const Mesh& b) {
  return a.triangles == b.triangles && std::equal(a.vertices.begin(), a.vertices.end(),
                                                  b.vertices.begin(), b.vertices.end(), SameVertex);
}

}  // namespace vismap::testing_support
