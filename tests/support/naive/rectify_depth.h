#pragma once

#include "geometry/image.h"
#include "rectify/rectify_depth.h"

namespace vismap::naive {

/// RectifyDepth of libs/rectify, pixel by pixel.
Image<float> RectifyDepth(const Image<float>& depth_m, const DepthTable& table);

}  // namespace vismap::naive
