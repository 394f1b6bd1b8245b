#pragma once

#include <vector>

#include "segmentation/pixel_ownership.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Mean depth of every segment [m].
std::vector<double> MeanDepths(const SegmentedFrame& frame);

/// The largest segment of every detection of the frame; kNone = the detection has no segment.
std::vector<SegmentIndex> LargestSegments(const std::vector<FrameSegment>& segments,
                                          size_t detection_count);

/// Whether something at `depth` may be a part of an object at `object_depth` with this mask: the
/// difference [m] is at most `extent` times the larger side of the mask's box, in metres at the
/// object's depth. Always true when `extent` is 0.
bool IsWithinExtent(double depth, double object_depth, const Mask& mask,
                    const PinholeCamera& camera, double extent);

/// The segments of a frame, without the detections of those that are seen through gaps of an object
/// or hide it: their depth is not within `max_extent` of the detection's largest segment.
/// `depths` = MeanDepths of the frame.
std::vector<FrameSegment> DropSeenThrough(const SegmentedFrame& frame,
                                          const PixelOwnership& ownership,
                                          const std::vector<double>& depths, double max_extent);

}  // namespace vismap
