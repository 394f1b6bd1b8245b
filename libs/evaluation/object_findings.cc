#include "evaluation/object_findings.h"

#include <algorithm>

namespace vismap {
namespace {

double ShareOf(int64_t part, int64_t all) {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

// The true object with most points in each group besides `truth`; none if more of the group's
// points are not annotated.
std::optional<size_t> OtherOwner(const InstanceMatches& groups, size_t group, size_t truth) {
  int64_t most = groups.predictions[group].on_void;
  std::optional<size_t> owner;
  for (size_t other = 0; other < groups.truths.size(); ++other) {
    if (other == truth || groups.Common(other, group) <= most) continue;
    most = groups.Common(other, group);
    owner = groups.truths[other].object;
  }
  return owner;
}

FoundAs Judge(const ObjectFinding& finding, double in_any_group, double purity_of_largest) {
  if (finding.iou > 0.5) return FoundAs::kFound;
  if (in_any_group <= 0.5) return FoundAs::kMissing;
  return purity_of_largest < 0.5 ? FoundAs::kSwallowed : FoundAs::kBroken;
}

ObjectFinding Explain(const InstanceMatches& groups, size_t truth) {
  const int64_t points = groups.truths[truth].vertices;
  ObjectFinding finding{.object = groups.truths[truth].object, .points = points};
  int64_t in_groups = 0, most = 0;
  std::optional<size_t> largest;
  for (const auto& [group, common] : groups.common[truth]) {
    in_groups += common;
    finding.pieces += ShareOf(common, points) > 0.1;
    if (common > most) largest = group;
    most = std::max(most, common);
    const double iou = groups.Iou(truth, group);
    if (iou <= finding.iou) continue;
    finding.iou = iou;
    finding.covered = ShareOf(common, points);
    finding.purity = ShareOf(common, groups.predictions[group].vertices);
  }
  if (!largest) return finding;  // no group has any of its points
  finding.in_largest = ShareOf(most, points);
  finding.shared_with = OtherOwner(groups, *largest, truth);
  finding.found = Judge(finding, ShareOf(in_groups, points),
                        ShareOf(most, groups.predictions[*largest].vertices));
  return finding;
}

}  // namespace

std::vector<ObjectFinding> FindObjects(const GroundTruth& truth, const InstanceMatches& groups,
                                       const DiscoveryOptions& options) {
  std::vector<ObjectFinding> findings;
  for (size_t t = 0; t < groups.truths.size(); ++t) {
    const TrueObject& object = truth.objects[groups.truths[t].object];
    if (!object.is_structure && IsCounted(object, groups.truths[t].vertices, options))
      findings.push_back(Explain(groups, t));
  }
  return findings;
}

}  // namespace vismap
