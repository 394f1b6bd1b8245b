#pragma once

#include <span>

#include "detection/box.h"
#include "segmentation/detections.h"

namespace vismap {

/// Grid of the chance [0, 1] that something is the object, laid over an image: image pixel u has
/// its centre at grid column (u + 0.5) * scale_u + offset_u, where column i is [i, i + 1); rows
/// alike.
struct SoftMask {
  int width = 0, height = 0;
  std::span<const float> values;  ///< height x width, rows first
  double scale_u = 1, scale_v = 1;
  double offset_u = 0, offset_v = 0;
};

/// The pixels of an image of `image_width` x `image_height` whose centres lie in `box` (image
/// pixels) and where the grid, bilinear between its centres and constant beyond them, is above
/// `threshold`. Empty when there are none.
Mask MaskFromSoft(const SoftMask& soft, const Box& box, int image_width, int image_height,
                  float threshold);

}  // namespace vismap
