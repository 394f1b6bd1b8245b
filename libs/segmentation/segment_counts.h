#pragma once

#include <cstdint>
#include <vector>

#include "segmentation/pixel_ownership.h"
#include "segmentation/runs.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// The runs of pixels of one segment each, row by row from left to right.
RunTable SegmentRuns(const Image<SegmentIndex>& index);

/// The number of pixels of every segment.
std::vector<int32_t> CountPixels(const SegmentImage& image);

/// The segments of a frame, and how many of their pixels belong to which detection.
struct SegmentCounts {
  SegmentImage image;
  std::vector<int32_t> pixels;  ///< of every segment
  /// inside[r][i] = pixels of segment i that belong to the r-th detection of the ranking. A row may
  /// be shorter than `pixels`; the segments after its end have no such pixel.
  std::vector<std::vector<int32_t>> inside;
};
SegmentCounts CountSegments(SegmentImage image, const PixelOwnership& ownership);

/// Counts `inside` again, after pixels moved to other segments.
void CountInside(const PixelOwnership& ownership, SegmentCounts* counts);

}  // namespace vismap
