#pragma once

#include <vector>

#include "segmentation/segment_counts.h"

namespace vismap {

/// Every segment without a detection.
std::vector<FrameSegment> SegmentsWithoutDetection(const std::vector<int32_t>& pixels);

/// Every segment with the detection that owns the largest part of its pixels (the paper's
/// p_i = |region in mask| / |region|), if that part is more than `min_overlap` (the paper's tau_p).
/// Of several with equal parts, the best one in the ranking.
std::vector<FrameSegment> MatchDetections(const SegmentCounts& counts,
                                          const PixelOwnership& ownership, double min_overlap);

}  // namespace vismap
