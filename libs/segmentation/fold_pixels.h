#pragma once

#include "segmentation/pixel_ownership.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Lets masks draw the border of objects along folds, where geometry decides it only roughly.
///
/// From the fold pixels of its segments, every detection with at least `min_score` grows over
/// neighbouring fold pixels that belong to it, lie on one surface with those, and are of a segment
/// without detection. Best detection first. The segments' overlaps stay as they were.
SegmentedFrame AssignFoldPixels(SegmentedFrame frame, const PixelOwnership& ownership,
                                double min_score);

}  // namespace vismap
