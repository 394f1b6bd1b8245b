#include "meshing/contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "meshing/label_surfaces.h"
#include "meshing/structure.h"

namespace vismap {
namespace {

/// The planes of structure, by segment.
using Planes = std::vector<std::optional<SurfacePlane>>;

Planes FindStructure(const Mesh& mesh) {
  size_t labels = 0;
  for (const MeshVertex& vertex : mesh.vertices)
    labels = std::max<size_t>(labels, Raw(vertex.segment) + size_t{1});
  const LabelSurfaces surfaces = CollectSurfaces(mesh, labels);
  std::vector<uint8_t> of_instance(labels);
  for (const MeshVertex& vertex : mesh.vertices) {
    if (vertex.instance != InstanceId::kNone) of_instance[Raw(vertex.segment)] = 1;
  }
  const StructureOptions options;
  Planes planes(labels);
  ParallelFor(labels, 1, [&](size_t label) {
    if (label == Raw(SegmentLabel::kNone) || of_instance[label] != 0 ||
        surfaces[label].area < options.area)
      return;
    const SurfacePlane plane = FindPlane(surfaces[label].points_W, surfaces[label].area, options);
    if (plane.area >= options.area && plane.share >= options.share) planes[label] = plane;
  });
  return planes;
}

double DistanceTo(const SurfacePlane& plane, const MeshVertex& vertex) {
  return std::abs((vertex.position_W.cast<double>() - plane.point_W).dot(plane.normal_W));
}

}  // namespace

void AbsorbContacts(double distance, Mesh* mesh) {
  const Planes planes = FindStructure(*mesh);
  // The distance first, then the label: the least of them is the same in whatever order.
  using Contact = std::pair<double, SegmentLabel>;
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<Contact> closest(mesh->vertices.size(), {kNever, SegmentLabel::kNone});
  const auto touch = [&](uint32_t rim, uint32_t beside) {
    const SegmentLabel segment = mesh->vertices[beside].segment;
    const auto& plane = planes[Raw(segment)];
    if (!plane || planes[Raw(mesh->vertices[rim].segment)]) return;
    const double away = DistanceTo(*plane, mesh->vertices[rim]);
    if (away <= distance) closest[rim] = std::min(closest[rim], {away, segment});
  };
  for (const auto& triangle : mesh->triangles) {
    for (size_t i = 0; i < 3; ++i) {
      touch(triangle[i], triangle[(i + 1) % 3]);
      touch(triangle[(i + 1) % 3], triangle[i]);
    }
  }
  for (size_t i = 0; i < closest.size(); ++i) {
    if (closest[i].second != SegmentLabel::kNone) mesh->vertices[i].segment = closest[i].second;
  }
}

}  // namespace vismap
