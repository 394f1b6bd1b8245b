#pragma once

#include "segmentation/segment_counts.h"

namespace vismap {

/// Splits segments that geometry could not, such as a picture on a wall or a cup on a table.
///
/// For every detection with at least split_min_score, best first: take the segment in which most of
/// its pixels lie. If at least split_min_mask_part of the detection's pixels lie there, and both
/// parts of the segment are large enough, the pixels that belong to the detection become a segment
/// of their own, with the next index. The rest stays whole, so that the blurred border of a mask
/// never becomes a segment. The counts returned are those after all splits.
SegmentCounts SplitSegments(SegmentCounts counts, const PixelOwnership& ownership,
                            const RefineOptions& options);

}  // namespace vismap
