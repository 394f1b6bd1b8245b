#pragma once

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Takes the pixels of detections of the classes to leave out (people, animals: what moves) out of
/// a frame: their depth becomes NaN, so that no stage after this one sees surface, free space or
/// segments there. Masks are grown by the margin first. Detections below min_score, and masks for
/// images of another size beyond the border, count as in RefineWithDetections. Returns how many
/// pixels with depth were taken out.
int64_t LeaveOut(const DetectionSet& detections, const RefineOptions& options, RgbdFrame* frame);

/// The detections that are not of classes to leave out.
DetectionSet WithoutLeftOut(const DetectionSet& detections, const RefineOptions& options);

}  // namespace vismap
