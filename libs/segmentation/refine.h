#pragma once

// Semantic refinement (Grinvald 2019, Sec. III-B; libs/METHOD.md, Refinement): which detection each
// segment of a frame belongs to. Departures from the paper: several detections of one thing become
// one; a pixel in several masks belongs to one detection; a good mask may split a segment that
// geometry could not; pieces and fold pixels that geometry could not place go to the object whose
// mask covers them.

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Matches the segments of a frame with the detections of a detector, in these steps:
/// 1. every pixel gets an owner among the detections (pixel_ownership.h);
/// 2. good masks split segments (split_segments.h);
/// 3. every segment gets the detection that covers most of it (match_detections.h);
/// 4. segments seen through gaps of an object lose it again (seen_through.h);
/// 5. loose pieces go to the objects that they belong to (loose_pieces.h);
/// 6. so do pixels on folds (fold_pixels.h).
/// `detections` = nullptr: no detector processed this frame; the segments are only counted. Masks
/// are cut at the image's border. Throws when frame and segment image differ in size.
SegmentedFrame RefineWithDetections(RgbdFrame frame, SegmentImage image,
                                    const DetectionSet* detections, const RefineOptions& options);

}  // namespace vismap
