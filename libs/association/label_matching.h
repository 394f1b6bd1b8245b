#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "association/point_counts.h"

namespace vismap {

/// Number of points of a segment whose voxels choose a label; the paper's Pi.
struct LabelOverlap {
  int32_t segment = -1;
  SegmentLabel label = SegmentLabel::kNone;
  int64_t points = 0;
};

/// The labels that segments got.
struct LabelMatching {
  std::map<SegmentLabel, int> segment_of;
  /// Final overlaps: every voxel chooses its strongest label that no other segment got. Ascending
  /// by segment, then label; without empty ones.
  std::vector<LabelOverlap> overlaps;
};

/// Matches segments and labels one to one. The pair with the largest overlap above `min_points`
/// goes first, ties to the lower segment, then the lower label. Then points of other segments whose
/// voxels chose this label pass to the next choice of their voxel, and so on.
LabelMatching MatchLabels(const FrameCounts& counts, int64_t min_points);

}  // namespace vismap
