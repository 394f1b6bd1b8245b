#pragma once

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The whole stage: removes things that move (LeaveOut), takes out depth beyond the limits and
/// fills small holes of the depth (PrepareDepth), computes the surface, segments it and matches the
/// segments with the detections. `detections` = nullptr: no detector processed this frame. The
/// depth of the result is NaN where things were removed, and has the holes filled.
SegmentedFrame SegmentFrame(RgbdFrame frame, const DetectionSet* detections,
                            const SegmentationStageOptions& options);

}  // namespace vismap
