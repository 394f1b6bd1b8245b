#pragma once

// Semantic refinement (Grinvald 2019, Sec. III-B): which detection each segment belongs to.
// Departures: several masks of one thing become one, overlapping masks are resolved first, and a
// good mask may split a segment that geometry could not.

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Gives each segment the detection whose mask covers most of it, if that is more than min_overlap;
/// ties go to the higher score, then the smaller mask,
/// then the lower index. A mask that lies mostly in one larger segment
/// cuts its part out of it first (a cup on a table, a picture on a wall); the part outside stays
/// whole, so a mask's soft rim never becomes an object of its own. `detections` = nullptr: no
/// detector looked at this frame. Masks are cut at the image's border. Throws when frame and
/// segment image differ in size.
SegmentedFrame RefineWithDetections(RgbdFrame frame, SegmentImage image,
                                    const DetectionSet* detections, const RefineOptions& options);

}  // namespace vismap
