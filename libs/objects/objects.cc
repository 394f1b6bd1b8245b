#include "objects/objects.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "meshing/mesh_parts.h"
#include "objects/find_up.h"
#include "objects/join_parts.h"
#include "objects/label_surfaces.h"
#include "objects/map_mesh.h"
#include "objects/read_out.h"

namespace vismap {
namespace {

std::vector<Eigen::Vector3f> PointsOf(const ObjectSummary& object, const LabelSurfaces& surfaces) {
  std::vector<Eigen::Vector3f> points;
  for (const SegmentLabel label : object.segments) {
    const auto& more = surfaces[Raw(label)].points_W;
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

// Number of vertices of each label. With `former`, plus the voxels that were seen empty since it
// was last observed: about what it had before it was removed.
std::vector<double> SizesOf(const LabelTable& table, const LabelSurfaces& surfaces, bool former) {
  std::vector<double> sizes;
  for (const LabelSurface& surface : surfaces)
    sizes.push_back(static_cast<double>(surface.vertices));
  for (size_t l = 1; former && l < sizes.size() && l <= table.records().size(); ++l)
    sizes[l] += table.records()[l - 1].cleared_voxels;
  return sizes;
}

double Score(const ObjectSummary& object, const LabelTable& table, const LabelReadOut& read_out,
             const std::vector<double>& sizes) {
  double confidence = 0, points = 0, confirmations = 0;
  for (const SegmentLabel label : object.segments) {
    const double size = sizes[Raw(label)];
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

// How many surface voxels of some labels were seen empty since the labels were last observed, and
// the time of the last such frame.
struct Clearing {
  int64_t voxels = 0;
  int64_t utime = 0;  // [us]
};

Clearing ClearingOf(const std::vector<SegmentLabel>& labels, const LabelTable& table) {
  Clearing clearing;
  for (const SegmentLabel label : labels) {
    const LabelRecord& record = table.Record(label);
    clearing.voxels += record.cleared_voxels;
    clearing.utime = std::max(clearing.utime, record.cleared_utime);
  }
  return clearing;
}

void SetClass(const InstanceReading& reading, ObjectSummary* object) {
  object->class_id = reading.class_id;
  object->class_probability = reading.class_probability;
}

ObjectSummary FromInstance(InstanceId id, const InstanceReading& reading) {
  ObjectSummary object;
  object.instance = id;
  object.segments = reading.labels;
  SetClass(reading, &object);
  return object;
}

int64_t CountPoints(const std::vector<SegmentLabel>& labels, const LabelSurfaces& surfaces) {
  int64_t count = 0;
  for (const SegmentLabel label : labels) {
    count += surfaces[Raw(label)].vertices;
  }
  return count;
}

// Sets the state of an object. Returns whether it is to be listed: it was removed, or it has enough
// surface.
bool SetState(const LabelTable& table, const LabelSurfaces& surfaces, const ObjectOptions& options,
              ObjectSummary* object) {
  const int64_t least =
      object->discovered() ? options.min_discovered_points : options.min_instance_points;
  const int64_t points = CountPoints(object->segments, surfaces);
  const Clearing clearing = ClearingOf(object->segments, table);
  if (clearing.voxels >= std::max(least, int64_t{1}) &&
      static_cast<double>(points) <
          options.removed_max_rest * static_cast<double>(clearing.voxels)) {
    object->state = ObjectState::kRemoved;
    object->removed_utime = clearing.utime;
    return true;
  }
  return points >= least;
}

// The discovered objects with their segments only, by their first segment. A segment that was
// removed is part of nothing that is still there.
std::vector<ObjectSummary> Discovered(const LabelTable& table, const LabelReadOut& read_out,
                                      const LabelSurfaces& surfaces, const ObjectOptions& options,
                                      std::span<const SegmentLabel> whole_of) {
  const auto was_removed = [&](const ObjectSummary& segment) {
    ObjectSummary alone = segment;
    return SetState(table, surfaces, options, &alone) && alone.removed();
  };
  std::vector<ObjectSummary> discovered;
  std::map<SegmentLabel, ObjectSummary> wholes;
  for (const SegmentLabel label : table.Alive()) {
    if (read_out.labels[Raw(label)].instance != InstanceId::kNone) continue;
    ObjectSummary segment;
    segment.segments = {label};
    if (whole_of.empty() || was_removed(segment)) {
      discovered.push_back(std::move(segment));
    } else {
      wholes[whole_of[Raw(label)]].segments.push_back(label);
    }
  }
  for (auto& [lowest, whole] : wholes) discovered.push_back(std::move(whole));
  std::sort(discovered.begin(), discovered.end(),
            [](const ObjectSummary& a, const ObjectSummary& b) { return a.segments < b.segments; });
  return discovered;
}

int64_t NewestUtime(const LabelTable& table) {
  int64_t newest = 0;
  for (const LabelRecord& record : table.records())
    newest = std::max({newest, record.last_utime, record.cleared_utime});
  return newest;
}

// Erases the removed objects that are too old or too many. Objects that were removed in the same
// frame are kept or erased together.
void EraseOldest(int64_t newest_utime, const ObjectOptions& options,
                 std::vector<ObjectSummary>* removed) {
  const double max_age = options.removed_max_age_s * 1e6;  // [us]
  std::vector<int64_t> times;
  for (const ObjectSummary& object : *removed) times.push_back(object.removed_utime);
  std::sort(times.begin(), times.end(), std::greater<>());
  const auto most = static_cast<size_t>(options.removed_max_count);
  std::erase_if(*removed, [&](const ObjectSummary& object) {
    const int64_t age = newest_utime - object.removed_utime;
    if (max_age > 0 && static_cast<double>(age) > max_age) return true;  // too old
    // Too many: only objects that were removed after the first one to erase are kept.
    return times.size() > most && object.removed_utime <= times[most];
  });
}

// The objects to list, present ones first, with their ids, classes and states only.
std::vector<ObjectSummary> ListObjects(const LabelTable& table, const LabelReadOut& read_out,
                                       const LabelSurfaces& surfaces, const ObjectOptions& options,
                                       std::span<const SegmentLabel> whole_of) {
  std::vector<ObjectSummary> objects, removed;
  const auto list = [&](ObjectSummary object) {
    if (!SetState(table, surfaces, options, &object)) return;
    (object.removed() ? removed : objects).push_back(std::move(object));
  };
  for (const auto& [id, reading] : read_out.instances) list(FromInstance(id, reading));
  for (ObjectSummary& object : Discovered(table, read_out, surfaces, options, whole_of))
    list(std::move(object));
  if (removed.empty()) return objects;  // NewestUtime need not be computed
  EraseOldest(NewestUtime(table), options, &removed);
  objects.insert(objects.end(), std::make_move_iterator(removed.begin()),
                 std::make_move_iterator(removed.end()));
  return objects;
}

// Whether a discovered segment that is not structure is significant enough to be listed.
bool IsThing(const ObjectSummary& object, const ObjectOptions& options) {
  if (object.frames < static_cast<uint32_t>(options.min_discovered_frames)) return false;
  return object.removed() ||
         (object.area >= options.min_discovered_area_m2 &&
          object.area >= options.min_discovered_fill * SpannedArea(object.spread));
}

}  // namespace

LabelSurfaces CollectSurfaces(const Mesh& mesh, size_t labels) {
  LabelSurfaces surfaces(labels);
  for (const MeshVertex& vertex : mesh.vertices) {
    const size_t label = Raw(vertex.segment);
    if (label >= labels) continue;
    surfaces[label].points_W.push_back(vertex.position_W);
    ++surfaces[label].vertices;
  }
  // Each corner gives a third of the triangle's area to its label.
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const double third = TriangleArea(mesh, i) / 3;
    for (const uint32_t corner : mesh.triangles[i]) {
      const size_t label = Raw(mesh.vertices[corner].segment);
      if (label < labels) surfaces[label].area += third;
    }
  }
  return surfaces;
}

std::vector<ObjectSummary> ReadObjects(const LabelTable& table, const LabelSurfaces& surfaces,
                                       const ObjectOptions& options,
                                       std::span<const SegmentLabel> whole_of) {
  const std::vector<double> sizes = SizesOf(table, surfaces, false);
  const std::vector<double> former_sizes = SizesOf(table, surfaces, true);
  const LabelReadOut read_out = ReadLabels(table, sizes);
  const LabelReadOut former = ReadLabels(table, former_sizes);
  std::vector<ObjectSummary> objects = ListObjects(table, read_out, surfaces, options, whole_of);
  for (ObjectSummary& object : objects) {
    for (const SegmentLabel label : object.segments) {
      AddHistory(table.Record(label), &object);
      object.area += surfaces[Raw(label)].area;
    }
    object.points = CountPoints(object.segments, surfaces);
    if (object.discovered()) continue;  // it has neither class nor score
    if (object.removed()) SetClass(former.instances.at(object.instance), &object);
    object.score = Score(object, table, read_out, object.removed() ? former_sizes : sizes);
  }
  return objects;
}

void MeasureObject(std::span<const Eigen::Vector3f> points_W, const ObjectOptions& options,
                   ObjectSummary* object) {
  if (object->removed()) return;
  object->box = FitUprightBox(MainParts(points_W, options.part_gap_m, options.min_part_share),
                              options.up_W, options.box_outliers);
  if (!object->discovered()) return;
  object->plane = FindPlane(points_W, object->area, options.structure);
  object->spread = SpreadOf(points_W);
}

void SetStructure(const ObjectOptions& options, std::vector<ObjectSummary>* objects) {
  std::vector<SurfacePlane> planes;
  std::vector<SurfaceSpread> spreads;
  double lowest = std::numeric_limits<double>::infinity();
  for (const ObjectSummary& object : *objects) {
    planes.push_back(object.plane);
    spreads.push_back(object.spread);
    if (object.removed()) continue;
    const double bottom = object.box.center_W.dot(options.up_W) - object.box.size.z() / 2;
    lowest = std::min(lowest, bottom);
  }
  JoinFlushAreas(spreads, options.structure, &planes);
  auto kinds = NameStructure(planes, options.up_W, lowest, options.structure);
  NameFlushPieces(planes, spreads, options.structure, &kinds);
  for (size_t i = 0; i < kinds.size(); ++i) (*objects)[i].structure = kinds[i];
}

void EraseInsignificant(const ObjectOptions& options, std::vector<ObjectSummary>* objects) {
  std::erase_if(*objects, [&](const ObjectSummary& object) {
    return object.discovered() && !object.is_structure() && !IsThing(object, options);
  });
}

std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map, const Mesh& mesh,
                                            const ObjectOptions& given, UpDirection* up) {
  const LabelSurfaces surfaces = CollectSurfaces(mesh, Raw(map.labels.next_label()));
  const UpDirection found = FindUp(given, surfaces);
  if (up != nullptr) *up = found;
  ObjectOptions options = given;
  options.up_W = found.up_W;
  options.up_is_guess = false;
  std::vector<SegmentLabel> whole_of;
  if (options.min_part_contact > 0) whole_of = JoinParts(map.labels, mesh, surfaces, options);
  std::vector<ObjectSummary> objects = ReadObjects(map.labels, surfaces, options, whole_of);
  ParallelFor(objects.size(), 1, [&](size_t i) {
    MeasureObject(PointsOf(objects[i], surfaces), options, &objects[i]);
  });
  SetStructure(options, &objects);
  EraseInsignificant(options, &objects);
  return objects;
}

std::vector<ObjectSummary> SummarizeObjects(const SemanticMap& map, const ObjectOptions& options) {
  return SummarizeObjects(map, ExtractMesh(map), options);
}

void ShowWholeObjects(const std::vector<ObjectSummary>& objects, Mesh* mesh) {
  std::map<SegmentLabel, SegmentLabel> shown;
  for (const ObjectSummary& object : objects) {
    if (!object.discovered()) continue;
    for (const SegmentLabel part : object.segments) shown.emplace(part, object.segments.front());
  }
  for (MeshVertex& vertex : mesh->vertices) {
    const auto found = shown.find(vertex.segment);
    if (found != shown.end()) vertex.segment = found->second;
  }
}

}  // namespace vismap
