#pragma once

#include <optional>

#include "evaluation/matches.h"

namespace vismap {

/// How well the map separates some true objects, whatever their class. Each is compared with the
/// group (instance, or segment without instance) that overlaps it most.
struct DiscoveryScore {
  int objects = 0;
  std::optional<double> recall25, recall50;  ///< share with IoU > 0.25, > 0.5; none without objects
  std::optional<double> mean_iou;            ///< none without objects
};

/// How well the map separates objects, whatever their class, over all true objects with enough
/// points and enough frames (DiscoveryOptions).
struct AnyClassScore {
  DiscoveryScore known;    ///< objects of COCO classes
  DiscoveryScore unknown;  ///< objects of other classes, which only the geometry can find
  /// Mean number of groups that hold more than a tenth of an object; none without objects.
  std::optional<double> fragments_per_object;
  int unknown_given_a_class =
      0;  ///< unknown objects with a class at more than half of their points
  /// Share of the points of floor, walls and ceiling that have a class in the map; none without
  /// such points.
  std::optional<double> structure_named_object;
};

struct DiscoveryOptions {
  int64_t min_vertices = 60;  ///< objects with fewer points are left out
  int min_frames = 5;         ///< objects that fewer frames show are left out
};

/// Whether an object with so many points of the ground truth is counted.
bool IsCounted(const TrueObject& object, int64_t vertices, const DiscoveryOptions& options);

/// `groups` must be MatchGroups(truth, labels).
AnyClassScore ScoreAnyClass(const GroundTruth& truth, const TransferredLabels& labels,
                            const InstanceMatches& groups, const DiscoveryOptions& options);

}  // namespace vismap
