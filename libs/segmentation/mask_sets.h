#pragma once

#include "segmentation/detections.h"

namespace vismap {

/// Masks of one image as sets of pixels.
int32_t MaskArea(const Mask& mask);
int32_t SharedArea(const Mask& a, const Mask& b);
Mask UnionOf(const Mask& a, const Mask& b);

}  // namespace vismap
