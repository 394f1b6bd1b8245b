#pragma once

// Geometric segmentation of one depth image (Grinvald 2019, Sec. III-A). Departures from the paper:
// thresholds are in units of the sensor's noise instead of metres, pixels without depth are never
// used, and edge pixels are assigned to segments by a flood instead of a window search.

#include "geometry/surface.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Cuts a surface into segments: connected regions without depth jumps or concave folds inside.
/// Segments are numbered by their first pixel in row order. Pixels without depth belong to no
/// segment, nor do regions below min_segment_px that match none of their neighbours. Throws
/// when surface and camera differ in size.
SegmentImage SegmentDepth(const SurfaceMap& surface, const PinholeCamera& camera,
                          const SegmentationOptions& options);

}  // namespace vismap
