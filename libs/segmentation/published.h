#pragma once

#include "geometry/surface.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The segmentation of the published code (Grinvald 2019, Sec. III-A). A pixel is an edge when the
/// depth in its 3x3 window differs by more than a fixed ratio (a hole counts as depth 0), or when a
/// neighbour in its 5x5 window is concave. Edge pixels are then assigned to the region of the
/// nearest point in their 9x9 window. Departures from that code: regions are 4-connected components
/// instead of contours, and the convexity test skips neighbours without depth. Used for comparison,
/// and as the slow reference of the benchmark.
SegmentImage SegmentAsPublished(const SurfaceMap& surface, int min_pixels,
                                const SegmentationOptions& options);

}  // namespace vismap
