#pragma once

#include "segmentation/detections.h"

namespace vismap {

// Masks of one image as sets of pixels.

/// Number of pixels in a mask.
int32_t MaskArea(const Mask& mask);
/// Number of pixels in both masks.
int32_t SharedArea(const Mask& a, const Mask& b);
/// The pixels in at least one of the masks.
Mask UnionOf(const Mask& a, const Mask& b);

}  // namespace vismap
