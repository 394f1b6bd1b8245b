#pragma once

#include "geometry/smooth_depth.h"

namespace vismap::naive {

/// SmoothDepth, one pixel at a time. Equal to the fast one bit for bit.
Image<float> SmoothDepth(const Image<float>& depth, const DepthNoiseModel& noise,
                         const DepthSmoothing& options);

}  // namespace vismap::naive
