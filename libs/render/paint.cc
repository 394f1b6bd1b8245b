#include "render/paint.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "meshing/mesh_parts.h"
#include "render/palette.h"

namespace vismap {
namespace {

double HeightOf(const MeshVertex& vertex, const Eigen::Vector3d& up_W) {
  return vertex.position_W.cast<double>().dot(up_W);
}

// The heights between which all vertices are but the lowest and the highest 1 %.
std::pair<double, double> UsualHeights(const Mesh& mesh, const Eigen::Vector3d& up_W) {
  std::vector<double> heights;
  const size_t stride = mesh.vertices.size() / 100000 + 1;
  for (size_t i = 0; i < mesh.vertices.size(); i += stride) {
    const double height = HeightOf(mesh.vertices[i], up_W);
    if (std::isfinite(height)) heights.push_back(height);
  }
  if (heights.empty()) return {0, 1};
  std::sort(heights.begin(), heights.end());
  const size_t cut = heights.size() / 100;
  const double low = heights[cut], high = heights[heights.size() - 1 - cut];
  return {low, std::max(high, low + 0.01)};
}

}  // namespace

ColorScale PaintHeights(const Eigen::Vector3d& up_W, Mesh* mesh) {
  const auto [low, high] = UsualHeights(*mesh, up_W);
  for (MeshVertex& vertex : mesh->vertices)
    vertex.color = RampColor((HeightOf(vertex, up_W) - low) / (high - low));
  return {"height in W", MetresText(low), MetresText(high)};
}

ColorScale PaintSeen(Mesh* mesh) {
  for (MeshVertex& vertex : mesh->vertices)
    vertex.color = vertex.seen == 0 ? kUnsegmentedColor : RampColor(std::log2(vertex.seen) / 8);
  return {"seen by frames", "1", "255 or more"};
}

void CutAbove(const Eigen::Vector3d& up_W, double height_m, Mesh* mesh) {
  std::vector<uint8_t> keep;
  for (const std::array<uint32_t, 3>& triangle : mesh->triangles) {
    keep.push_back(std::all_of(triangle.begin(), triangle.end(), [&](uint32_t corner) {
      return HeightOf(mesh->vertices[corner], up_W) < height_m;
    }));
  }
  // Vertices of no triangle are dropped, too: they would count for the bounds of the scene.
  *mesh = KeepTriangles(*mesh, keep);
}

}  // namespace vismap
