#pragma once

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The whole stage: what is left out goes, then surface, segments, detections. `detections` =
/// nullptr: no detector looked at this frame. The depth of the result is NaN where things were left
/// out.
SegmentedFrame SegmentFrame(RgbdFrame frame, const DetectionSet* detections,
                            const SegmentationStageOptions& options);

}  // namespace vismap
