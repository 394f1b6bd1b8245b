#pragma once

#include <span>

#include "detection/box.h"
#include "segmentation/detections.h"

namespace vismap {

/// A grid over an image with the probability [0, 1] that a cell belongs to the object. The centre
/// of image pixel u is at (u + 0.5) * scale_u + offset_u in the grid, where column i covers [i, i +
/// 1). The same holds for rows.
struct SoftMask {
  int width = 0, height = 0;
  std::span<const float> values;  ///< height x width, row-major
  double scale_u = 1, scale_v = 1;
  double offset_u = 0, offset_v = 0;
};

/// The pixels of an image of `image_width` x `image_height` whose centres are in `box` (image
/// pixels) and at which the grid is above `threshold`. The grid is interpolated bilinearly between
/// the centres of its cells, and constant outside of them. The mask is empty if there are no such
/// pixels.
Mask MaskFromSoft(const SoftMask& soft, const Box& box, int image_width, int image_height,
                  float threshold);

}  // namespace vismap
