#include "evaluation/discovery.h"

#include <algorithm>

namespace vismap {
namespace {

// The IoU of a true object with the group that overlaps it most.
double BestIou(const InstanceMatches& groups, size_t truth) {
  double best = 0;
  for (const auto& entry : groups.common[truth])
    best = std::max(best, groups.Iou(truth, entry.first));
  return best;
}

// Number of groups that hold more than a tenth of a true object.
int Fragments(const InstanceMatches& groups, size_t truth) {
  int fragments = 0;
  for (const auto& entry : groups.common[truth]) {
    fragments += static_cast<double>(entry.second) >
                 0.1 * static_cast<double>(groups.truths[truth].vertices);
  }
  return fragments;
}

double MeanOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

DiscoveryScore Summarise(const std::vector<double>& ious) {
  DiscoveryScore score;
  score.objects = static_cast<int>(ious.size());
  if (ious.empty()) return score;
  const auto share_above = [&](double overlap) {
    return static_cast<double>(
               std::count_if(ious.begin(), ious.end(), [&](double iou) { return iou > overlap; })) /
           static_cast<double>(ious.size());
  };
  score.recall25 = share_above(0.25);
  score.recall50 = share_above(0.5);
  score.mean_iou = MeanOf(ious);
  return score;
}

// Number of points of an object or of all structure, and of those with a class in the map.
struct NamedShare {
  int64_t points = 0, named = 0;
  double share() const { return static_cast<double>(named) / static_cast<double>(points); }
};

}  // namespace

bool IsCounted(const TrueObject& object, int64_t vertices, const DiscoveryOptions& options) {
  return vertices >= options.min_vertices && object.frames >= options.min_frames;
}

AnyClassScore ScoreAnyClass(const GroundTruth& truth, const TransferredLabels& labels,
                            const InstanceMatches& groups, const DiscoveryOptions& options) {
  NamedShare structure;
  std::vector<NamedShare> named(truth.objects.size());
  const std::vector<int> objects = truth.ObjectOfPoints();
  for (size_t i = 0; i < objects.size(); ++i) {
    if (objects[i] < 0) continue;  // the point belongs to no object
    const auto object = static_cast<size_t>(objects[i]);
    NamedShare& share = truth.objects[object].is_structure ? structure : named[object];
    ++share.points;
    share.named += labels.class_id[i] != ClassId::kUnknown;
  }
  AnyClassScore score;
  std::vector<double> known, unknown, fragments;
  for (size_t t = 0; t < groups.truths.size(); ++t) {
    const TrueObject& object = truth.objects[groups.truths[t].object];
    if (!IsCounted(object, groups.truths[t].vertices, options)) continue;
    const bool is_known = object.class_id != ClassId::kUnknown;
    (is_known ? known : unknown).push_back(BestIou(groups, t));
    fragments.push_back(Fragments(groups, t));
    if (!is_known && named[groups.truths[t].object].share() > 0.5) ++score.unknown_given_a_class;
  }
  score.known = Summarise(known);
  score.unknown = Summarise(unknown);
  if (!fragments.empty()) score.fragments_per_object = MeanOf(fragments);
  if (structure.points > 0) score.structure_named_object = structure.share();
  return score;
}

}  // namespace vismap
