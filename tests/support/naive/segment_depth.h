#pragma once

#include "geometry/surface.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap::naive {

/// SegmentDepth with kNoiseScaled, one pixel at a time: every fold is tested exactly, components
/// are found by search, all pixels of all regions start the flood, sums go over pixels. The same
/// image as the fast one, whose sums over runs round differently in the 16th digit.
SegmentImage SegmentDepth(const SurfaceMap& surface, const PinholeCamera& camera,
                          const SegmentationOptions& options);

}  // namespace vismap::naive
