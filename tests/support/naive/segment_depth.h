#pragma once

#include "geometry/surface.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap::naive {

/// SegmentDepth with kNoiseScaled, one pixel at a time: it tests every fold exactly, finds
/// connected components by search, starts the flood from all pixels with a region, and sums over
/// pixels. The image is the same as that of the fast one. (Sums over runs differ in the 16th digit,
/// too little to change which regions are joined.)
SegmentImage SegmentDepth(const SurfaceMap& surface, const PinholeCamera& camera,
                          const SegmentationOptions& options);

}  // namespace vismap::naive
