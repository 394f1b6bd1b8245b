#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "association/point_counts.h"

namespace vismap {

/// Points of a segment whose voxels vote for a label; the paper's Pi.
struct LabelOverlap {
  int32_t segment = -1;
  SegmentLabel label = SegmentLabel::kNone;
  int64_t points = 0;
};

/// Which label each segment got, and what was left to say.
struct LabelMatching {
  std::map<SegmentLabel, int> segment_of;  ///< label to its segment
  /// With every voxel voting for its strongest label that no other segment got; ascending by
  /// segment, then label; only where there are points.
  std::vector<LabelOverlap> overlaps;
};

/// One-to-one matching in descending overlap above `min_points`, voxels falling back to their next
/// choice once a label is taken by another segment; ties to the lower segment, then the lower
/// label.
LabelMatching MatchLabels(const FrameCounts& counts, int64_t min_points);

}  // namespace vismap
