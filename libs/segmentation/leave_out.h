#pragma once

#include "segmentation/segmentation_options.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Removes things that move, such as people, from a frame: the depth of all pixels in masks of
/// RefineOptions::leave_out_classes becomes NaN, so that later stages find no surface, free space
/// or segment there. The masks are grown by the margin first. Detections below min_score are
/// ignored, and masks are cut at the image's border. Returns the number of pixels that lost their
/// depth.
int64_t LeaveOut(const DetectionSet& detections, const RefineOptions& options, RgbdFrame* frame);

/// The detections of all other classes.
DetectionSet WithoutLeftOut(const DetectionSet& detections, const RefineOptions& options);

}  // namespace vismap
