#include "meshing/object_tracker.h"

#include <algorithm>

#include "base/parallel.h"
#include "volume/surface_reader.h"

namespace vismap {
namespace {

constexpr size_t kMaxPoints = 2000;  // kept per label, for boxes
constexpr size_t kLargeBlocks = 200;
constexpr size_t kMaxBlocks = 300;  // looked at per label
constexpr size_t kBlocksAtOnce = 600;
constexpr double kGrowth = 1.1;
constexpr double kCleared = 0.1;  // seen empty, of the surface

void Thin(std::vector<Eigen::Vector3f>* points) {
  if (points->size() <= kMaxPoints) return;
  const size_t stride = (points->size() + kMaxPoints - 1) / kMaxPoints;
  std::vector<Eigen::Vector3f> picked;
  for (size_t i = 0; i < points->size(); i += stride) picked.push_back((*points)[i]);
  picked.shrink_to_fit();
  *points = std::move(picked);
}

}  // namespace

void ObjectTracker::NoteChanges(const SemanticMap& map, const MapDelta& delta) {
  for (const auto& [dead, survivor] : delta.merged) changed_.insert({dead, survivor});
  SurfaceReader reader;
  for (const BlockIndex& index : delta.changed_blocks) {
    const Block* block = map.voxels.Find(index);
    const SurfaceVoxels* surface = block != nullptr ? reader.Read(*block) : nullptr;
    if (surface != nullptr) changed_.insert(surface->palette.begin(), surface->palette.end());
    reader.Trim();
  }
}

std::vector<SegmentLabel> ObjectTracker::LabelsToMeasure(const SemanticMap& map,
                                                         const Places& places) {
  const size_t labels = Raw(map.labels.next_label());
  surfaces_.resize(labels);
  versions_.resize(labels);
  blocks_measured_.resize(labels);
  std::set<SegmentLabel> alive;
  for (const SegmentLabel label : changed_) {
    const SegmentLabel canonical = map.labels.Canonical(label);
    alive.insert(canonical);
    if (canonical != label) surfaces_[Raw(label)] = {};
  }
  std::vector<SegmentLabel> due;
  std::set<SegmentLabel> later;
  for (const SegmentLabel label : alive) {
    const size_t blocks = places(label).size(), before = blocks_measured_[Raw(label)];
    const bool large = blocks > kLargeBlocks;
    const bool grew = static_cast<double>(blocks) >= kGrowth * static_cast<double>(before);
    const bool shrank = map.labels.Record(label).cleared_voxels >
                        kCleared * static_cast<double>(surfaces_[Raw(label)].vertices);
    if (large && !grew && !shrank) {
      later.insert(label);
    } else {
      due.push_back(label);
    }
  }
  changed_ = std::move(later);
  return due;
}

// Some labels at a time, so that the surface of few blocks at once is in memory.
void ObjectTracker::MeasureLabels(const SemanticMap& map, std::span<const SegmentLabel> labels,
                                  const Places& places, const MeshingOptions& meshing) {
  for (size_t done = 0; done < labels.size();) {
    size_t count = 0;
    for (size_t blocks = 0; done + count < labels.size() && blocks < kBlocksAtOnce; ++count)
      blocks += std::min(places(labels[done + count]).size(), kMaxBlocks);
    MeasureTogether(map, labels.subspan(done, count), places, meshing);
    done += count;
  }
}

void ObjectTracker::MeasureTogether(const SemanticMap& map, std::span<const SegmentLabel> labels,
                                    const Places& places, const MeshingOptions& meshing) {
  std::vector<BlockIndex> blocks;
  std::vector<size_t> strides;
  for (const SegmentLabel label : labels) {
    const auto of_label = places(label);
    // Of large labels an even pick of blocks stands for all.
    strides.push_back(std::max<size_t>(1, (of_label.size() + kMaxBlocks - 1) / kMaxBlocks));
    for (size_t i = 0; i < of_label.size(); i += strides.back()) blocks.push_back(of_label[i]);
    blocks_measured_[Raw(label)] = of_label.size();
  }
  LabelSurfaces fresh =
      CollectSurfaces(ExtractMeshOf(map, std::move(blocks), meshing), surfaces_.size());
  for (size_t i = 0; i < labels.size(); ++i) {
    LabelSurface& surface = surfaces_[Raw(labels[i])];
    surface = std::move(fresh[Raw(labels[i])]);
    surface.vertices *= static_cast<int64_t>(strides[i]);
    surface.area *= static_cast<double>(strides[i]);
    Thin(&surface.points_W);
    ++versions_[Raw(labels[i])];
  }
}

std::vector<ObjectSummary> ObjectTracker::Summarize(const SemanticMap& map, const Places& places,
                                                    const MeshingOptions& meshing,
                                                    const ObjectOptions& given) {
  MeasureLabels(map, LabelsToMeasure(map, places), places, meshing);
  const ObjectOptions options = WithLevelUp(given, surfaces_);
  if (options.up_W != up_W_) measured_.clear();
  up_W_ = options.up_W;
  std::vector<ObjectSummary> objects = ReadObjects(map.labels, surfaces_, options);
  std::vector<Measured*> records;
  std::vector<std::vector<std::pair<SegmentLabel, uint32_t>>> from(objects.size());
  for (size_t i = 0; i < objects.size(); ++i) {
    const ObjectSummary& object = objects[i];
    for (const SegmentLabel label : object.segments)
      from[i].emplace_back(label, versions_[Raw(label)]);
    const Key key{object.instance,
                  object.discovered() ? object.segments.front() : SegmentLabel::kNone};
    records.push_back(&measured_[key]);
  }
  ParallelFor(objects.size(), 1, [&](size_t i) {
    if (objects[i].removed()) return;
    Measured& record = *records[i];
    if (record.from != from[i]) {
      MeasureObject(surfaces_, options, &objects[i]);
      record = {std::move(from[i]), objects[i].box, objects[i].plane};
    }
    objects[i].box = record.box;
    objects[i].plane = record.plane;
  });
  SetStructure(options, &objects);
  return objects;
}

}  // namespace vismap
