#pragma once

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The whole stage: surface, segments, detections. `detections` = nullptr: no detector looked at
/// this frame.
SegmentedFrame SegmentFrame(RgbdFrame frame, const DetectionSet* detections,
                            const SegmentationStageOptions& options);

}  // namespace vismap
