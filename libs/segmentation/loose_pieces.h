#pragma once

#include <vector>

#include "segmentation/pixel_ownership.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Attaches loose pieces to objects: connected pieces that are too small to be segments, such as
/// the legs of a chair (SegmentImage::loose).
///
/// A piece whose pixels are of no segment, or of one without detection, goes to the largest segment
/// of the best detection that owns more than min_overlap of its pixels and at whose depth it lies,
/// within loose_depth_extent (see IsWithinExtent). `depths` = MeanDepths of the frame before.
SegmentedFrame AttachLoosePieces(SegmentedFrame frame, const PixelOwnership& ownership,
                                 const std::vector<double>& depths, const RefineOptions& options);

}  // namespace vismap
