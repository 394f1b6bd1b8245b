#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/enum_names.h"
#include "evaluation/discovery.h"

namespace vismap {

/// What became of a true object in the map.
enum class FoundAs : uint8_t {
  kFound,   ///< a group has IoU > 0.5 with it
  kBroken,  ///< most of it is in groups that are mainly its own, but none of them is enough of it
  kSwallowed,  ///< the group with most of its points belongs mainly to something else
  kMissing,    ///< at most half of its points are in any group
};

inline constexpr auto NamesOf(FoundAs) {
  return std::to_array<EnumName<FoundAs>>({{"found", FoundAs::kFound},
                                           {"broken", FoundAs::kBroken},
                                           {"swallowed", FoundAs::kSwallowed},
                                           {"missing", FoundAs::kMissing}});
}

/// What the map made of one true object, and why it counts as found or not. A group is an instance
/// of the map, or a segment without an instance.
struct ObjectFinding {
  size_t object = 0;   ///< index in GroundTruth::objects
  int64_t points = 0;  ///< its points in the ground truth
  double iou = 0;      ///< with the group that overlaps it most, as in DiscoveryScore
  double covered = 0;  ///< share of the object's points that this group holds
  double purity = 0;   ///< share of this group's points that are on the object
  int pieces = 0;      ///< groups that hold more than a tenth of the object
  FoundAs found = FoundAs::kMissing;
  /// Of the group that holds most of the object's points: the share of the object in it, and what
  /// most of this group's other points are on.
  double in_largest = 0;
  /// Index in GroundTruth::objects, also of structure; none = not annotated, or there are no
  /// others.
  std::optional<size_t> shared_with{};
};

/// Explains all objects that ScoreAnyClass counts, in the order of the annotation. `groups` must be
/// MatchGroupsAndStructure(truth, labels).
std::vector<ObjectFinding> FindObjects(const GroundTruth& truth, const InstanceMatches& groups,
                                       const DiscoveryOptions& options);

}  // namespace vismap
