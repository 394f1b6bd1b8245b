#pragma once

#include <string>
#include <vector>

#include "freespace/slice.h"
#include "render/drawing.h"

/// The room `pictures` shows free space and whole runs: slices, octrees, reports.
namespace vismap {

struct SlicePictureOptions {
  int width = 1600;  ///< [px]; >= 320
  int height = 900;  ///< [px]; >= 240
  /// Lines of equal distance from what is occupied in the slice, through what is free in it [m].
  std::vector<double> contours_m = {0.1, 0.25, 0.5, 1, 2};
};

/// A slice in three colours (kFreeColor, kOccupiedColor, kNotSeenColor) with contours, axes in
/// metres and a legend with the area of each state. The first of the slice's axes goes to the
/// right, the second one up. A slice without cells gives a picture that says so.
Image<Rgb8> RenderSlice(const Slice& slice, const SliceQuestion& question, const std::string& title,
                        const SlicePictureOptions& options = {});

/// The smallest cell with which each cell of the slice has at least one pixel in its picture [m];
/// 0 = nothing is known of the space.
double SliceCellFor(const OccupancyMap& map, int axis, const SlicePictureOptions& options);

}  // namespace vismap
