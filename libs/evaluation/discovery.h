#pragma once

#include <optional>

#include "evaluation/matches.h"

namespace vismap {

/// Whether the objects of one kind were found as things of their own, whatever their class: each
/// against the group (instance, else segment) that overlaps it most.
struct DiscoveryScore {
  int objects = 0;
  std::optional<double> recall25, recall50;  ///< share with IoU > 0.25, > 0.5; none of no objects
  std::optional<double> mean_iou;
};

/// Finding things, over all objects that are large enough and were seen often enough.
struct AnyClassScore {
  DiscoveryScore known;    ///< objects whose class COCO has
  DiscoveryScore unknown;  ///< objects that only geometry can find
  /// Mean number of groups that hold more than a tenth of an object; none without objects.
  std::optional<double> fragments_per_object;
  int unknown_given_a_class = 0;  ///< unknown objects of which the map names more than half
  /// Share of the points of floor, walls and ceiling that belong to an object with a class; none
  /// without such points.
  std::optional<double> structure_named_object;
};

struct DiscoveryOptions {
  int64_t min_vertices = 60;  ///< objects with fewer points are left out
  int min_frames = 5;         ///< so are objects that fewer frames show
};

/// `groups` = MatchGroups of the same truth and labels.
AnyClassScore ScoreAnyClass(const GroundTruth& truth, const TransferredLabels& labels,
                            const InstanceMatches& groups, const DiscoveryOptions& options);

}  // namespace vismap
