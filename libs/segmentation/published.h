#pragma once

#include "geometry/surface.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The published code's segmentation (Grinvald 2019, Sec. III-A): depth steps in a 3x3 window above
/// a fixed ratio (a hole counts as depth 0) or concave neighbours in a 5x5 window are edges;
/// regions between edges get edge pixels back from a 9x9 window. Contours are replaced by
/// 4-connected components; neighbours without depth are skipped in the convexity test. Kept for
/// comparison, and as the slow reference of the benchmark.
SegmentImage SegmentAsPublished(const SurfaceMap& surface, int min_pixels,
                                const SegmentationOptions& options);

}  // namespace vismap
