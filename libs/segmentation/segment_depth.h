#pragma once

// Geometric segmentation of one depth image (Grinvald 2019, Sec. III-A). Departures from the paper:
// thresholds in units of the sensor's noise instead of constants, explicit validity, and edge
// pixels given back by a flood instead of a window search. See refine.h for what detections add.

#include "geometry/surface.h"
#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Cuts a surface into segments: connected, without depth jumps or concave folds inside. Segments
/// are numbered by their first pixel in row order. Pixels without depth never belong to one; pixels
/// of specks that fit no neighbour belong to none. Throws when the surface is not the camera's.
SegmentImage SegmentDepth(const SurfaceMap& surface, const PinholeCamera& camera,
                          const SegmentationOptions& options);

}  // namespace vismap
