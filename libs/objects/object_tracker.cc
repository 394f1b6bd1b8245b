#include "objects/object_tracker.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "base/parallel.h"
#include "meshing/block_set.h"
#include "objects/find_up.h"
#include "objects/keep_share.h"
#include "objects/label_surfaces.h"

namespace vismap {
namespace {

constexpr size_t kMaxPoints = 2000;      // about so many points at most are used per object
constexpr size_t kMaxBlocks = 600;       // points of so many blocks at most are used per label
constexpr int64_t kLargePoints = 10000;  // objects with more vertices are large
constexpr double kGrowth = 0.1;          // relative change after which a measurement is repeated

// The amount of surface of every label, without points.
LabelSurfaces AmountsOf(const SemanticMap& map, const BlockSurfaces& surfaces) {
  LabelSurfaces amounts(Raw(map.labels.next_label()));
  for (size_t i = 0; i < amounts.size(); ++i) {
    const BlockSurfaces::Amount amount = surfaces.AmountOf(static_cast<SegmentLabel>(i));
    amounts[i].vertices = amount.vertices;
    amounts[i].area = amount.area;
  }
  return amounts;
}

// A sample of the surface points of some labels [m]. Of labels in many blocks, only evenly chosen
// blocks are used.
std::vector<Eigen::Vector3f> PointsOf(std::span<const SegmentLabel> labels, const SemanticMap& map,
                                      const BlockSurfaces& surfaces,
                                      const ObjectTracker::Places& places) {
  std::vector<Eigen::Vector3f> points_W;
  for (const SegmentLabel label : labels) {
    // A cell belongs to the block of its lowest corner, so surface of the label may also be in the
    // blocks below those with its votes.
    const std::vector<BlockIndex> blocks = BlockSet(places(label)).Grown(1, 0).Blocks();
    const size_t stride = std::max<size_t>(1, (blocks.size() + kMaxBlocks - 1) / kMaxBlocks);
    for (size_t i = 0; i < blocks.size(); i += stride)
      surfaces.AddPoints(label, blocks[i], map.voxels.voxel_size(), &points_W);
  }
  KeepShare(static_cast<double>(kMaxPoints) / static_cast<double>(points_W.size() + 1), &points_W);
  return points_W;
}

bool IsLargeAndAsBefore(int64_t points, int64_t before) {
  const auto change = static_cast<double>(std::abs(points - before));
  return points > kLargePoints && change < kGrowth * static_cast<double>(before);
}

}  // namespace

// Estimates the upward direction again when the area of all surface has changed by a tenth. All
// boxes depend on this direction, so they are all measured again if it changes.
void ObjectTracker::UpdateUp(const SemanticMap& map, const BlockSurfaces& surfaces,
                             const Places& places, const ObjectOptions& options,
                             LabelSurfaces amounts) {
  double area = 0;
  for (const LabelSurface& amount : amounts) area += amount.area;
  if (std::abs(area - up_area_) < kGrowth * up_area_) return;  // the estimate is still valid
  up_area_ = area;
  const double least =
      MayBeRolled(options.cameras) ? kLeastPieceArea : options.structure.structure_area_m2;
  for (size_t i = 1; i < amounts.size(); ++i) {
    const auto label = static_cast<SegmentLabel>(i);
    if (amounts[i].area >= least)
      amounts[i].points_W = PointsOf(std::span(&label, 1), map, surfaces, places);
  }
  UpDirection up = FindUp(options, amounts);
  if (up.up_W != up_.up_W) measured_.clear();
  up_ = std::move(up);
}

std::vector<ObjectSummary> ObjectTracker::Summarize(const SemanticMap& map,
                                                    const BlockSurfaces& surfaces,
                                                    const Places& places,
                                                    const ObjectOptions& given) {
  const LabelSurfaces amounts = AmountsOf(map, surfaces);
  ObjectOptions options = given;
  if (given.up_is_guess) {
    UpdateUp(map, surfaces, places, given, amounts);
  } else {
    up_ = FindUp(given, amounts);
  }
  options.up_W = up_.up_W;
  options.up_is_guess = false;
  std::vector<ObjectSummary> objects = ReadObjects(map.labels, amounts, options);
  std::map<Key, Measured> measured;
  std::vector<Measured*> records;
  for (const ObjectSummary& object : objects) {
    const Key key{object.instance,
                  object.discovered() ? object.segments.front() : SegmentLabel::kNone};
    const auto known = measured_.find(key);
    records.push_back(
        &measured.emplace(key, known != measured_.end() ? std::move(known->second) : Measured{})
             .first->second);
  }
  ParallelFor(objects.size(), 1, [&](size_t i) {
    ObjectSummary& object = objects[i];
    if (object.removed()) return;  // it has no box
    Measured& record = *records[i];
    std::vector<std::pair<SegmentLabel, uint32_t>> from;
    for (const SegmentLabel label : object.segments)
      from.emplace_back(label, surfaces.AmountOf(label).version);
    if (from != record.from && !IsLargeAndAsBefore(object.points, record.points)) {
      MeasureObject(PointsOf(object.segments, map, surfaces, places), options, &object);
      record = {std::move(from), object.points, object.box, object.plane, object.spread};
    }
    object.box = record.box;
    object.plane = record.plane;
    object.spread = record.spread;
  });
  measured_ = std::move(measured);
  SetStructure(options, &objects);
  EraseInsignificant(options, &objects);
  return objects;
}

}  // namespace vismap
