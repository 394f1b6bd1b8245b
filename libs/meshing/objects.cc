#include "meshing/objects.h"

#include <algorithm>

#include "base/parallel.h"
#include "meshing/mesh_parts.h"
#include "meshing/read_out.h"

namespace vismap {
namespace {

// The surface of each label, indexed by label.
struct LabelSurfaces {
  std::vector<std::vector<Eigen::Vector3f>> points_W;
  std::vector<double> area;
};

LabelSurfaces CollectSurfaces(const Mesh& mesh, size_t labels) {
  LabelSurfaces surfaces;
  surfaces.points_W.resize(labels);
  surfaces.area.resize(labels, 0);
  for (const MeshVertex& vertex : mesh.vertices) {
    const size_t label = Raw(vertex.segment);
    if (label < labels) surfaces.points_W[label].push_back(vertex.position_W);
  }
  // A triangle between labels belongs to each of them by a third per corner.
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const double third = TriangleArea(mesh, i) / 3;
    for (const uint32_t corner : mesh.triangles[i]) {
      const size_t label = Raw(mesh.vertices[corner].segment);
      if (label < labels) surfaces.area[label] += third;
    }
  }
  return surfaces;
}

std::vector<Eigen::Vector3f> PointsOf(const ObjectSummary& object, const LabelSurfaces& surfaces) {
  std::vector<Eigen::Vector3f> points;
  for (const SegmentLabel label : object.segments) {
    const auto& more = surfaces.points_W[Raw(label)];
    points.insert(points.end(), more.begin(), more.end());
  }
  return points;
}

void AddHistory(const LabelRecord& record, ObjectSummary* object) {
  const bool first = object->frames == 0;
  object->first_utime =
      first ? record.first_utime : std::min(object->first_utime, record.first_utime);
  object->last_utime = std::max(object->last_utime, record.last_utime);
  object->frames = std::max(object->frames, record.frames);
}

double Score(const ObjectSummary& object, const LabelTable& table, const LabelReadOut& read_out,
             const LabelSurfaces& surfaces) {
  double confidence = 0, points = 0, confirmations = 0;
  for (const SegmentLabel label : object.segments) {
    const auto size = static_cast<double>(surfaces.points_W[Raw(label)].size());
    confidence += size * static_cast<double>(read_out.labels[Raw(label)].confidence);
    points += size;
    const auto& evidence = table.Record(label).instance_evidence;
    const auto found = evidence.find(object.instance);
    if (found != evidence.end()) {
      confirmations = std::max(confirmations, static_cast<double>(found->second));
    }
  }
  const auto share = object.class_probability.find(object.class_id);
  if (points == 0 || share == object.class_probability.end()) return 0;
  return std::clamp(confidence / points * share->second * confirmations / (confirmations + 1), 0.0,
                    1.0);
}

ObjectSummary FromInstance(InstanceId id, const InstanceReading& reading) {
  ObjectSummary object;
  object.instance = id;
  object.segments = reading.labels;
  object.class_id = reading.class_id;
  object.class_probability = reading.class_probability;
  return object;
}

ObjectSummary FromSegment(SegmentLabel label) {
  ObjectSummary object;
  object.segments = {label};
  return object;
}

bool IsStructure(const ObjectSummary& object, std::span<const Eigen::Vector3f> points,
                 const ObjectOptions& options) {
  if (object.area < options.structure_area) return false;
  const double inliers = FitPlane(points, options.structure_flatness).inliers;
  return inliers >= options.structure_share && inliers * object.area >= options.structure_area;
}

// Everything that is read from the surface.
void Measure(const LabelSurfaces& surfaces, const ObjectOptions& options, ObjectSummary* object) {
  const std::vector<Eigen::Vector3f> points = PointsOf(*object, surfaces);
  object->points = static_cast<int64_t>(points.size());
  for (const SegmentLabel label : object->segments) object->area += surfaces.area[Raw(label)];
  object->box = FitUprightBox(MainParts(points, options.part_gap, options.min_part_share),
                              options.up_W, options.box_outliers);
  object->is_structure = object->discovered() && IsStructure(*object, points, options);
}

int64_t CountPoints(const std::vector<SegmentLabel>& labels, const LabelSurfaces& surfaces) {
  int64_t count = 0;
  for (const SegmentLabel label : labels) {
    count += static_cast<int64_t>(surfaces.points_W[Raw(label)].size());
  }
  return count;
}

// Which objects there are; nothing measured yet.
std::vector<ObjectSummary> ListObjects(const LabelTable& table, const LabelReadOut& read_out,
                                       const LabelSurfaces& surfaces,
                                       const ObjectOptions& options) {
  std::vector<ObjectSummary> objects;
  for (const auto& [id, reading] : read_out.instances) {
    if (CountPoints(reading.labels, surfaces) < options.min_instance_points) continue;
    objects.push_back(FromInstance(id, reading));
  }
  for (const SegmentLabel label : table.Alive()) {
    if (read_out.labels[Raw(label)].instance != InstanceId::kNone) continue;
    if (CountPoints({label}, surfaces) < options.min_discovered_points) continue;
    objects.push_back(FromSegment(label));
  }
  return objects;
}

}  // namespace

std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map, const Mesh& mesh,
                                            const ObjectOptions& options) {
  const LabelTable& table = map.labels;
  const LabelReadOut read_out = ReadLabels(table, VerticesPerLabel(mesh));
  const LabelSurfaces surfaces = CollectSurfaces(mesh, Raw(table.next_label()));
  std::vector<ObjectSummary> objects = ListObjects(table, read_out, surfaces, options);
  ParallelFor(objects.size(), 1, [&](size_t i) { Measure(surfaces, options, &objects[i]); });
  for (ObjectSummary& object : objects) {
    for (const SegmentLabel label : object.segments) AddHistory(table.Record(label), &object);
    if (!object.discovered()) object.score = Score(object, table, read_out, surfaces);
  }
  return objects;
}

std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map, const ObjectOptions& options) {
  return SummarizeObjects(map, ExtractMesh(map), options);
}

}  // namespace vismap
