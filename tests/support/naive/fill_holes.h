#pragma once

#include "geometry/fill_holes.h"

namespace vismap::naive {

/// FillHoles, one pixel at a time: each pixel searches the two sides of its hole itself. Equal to
/// the fast one bit for bit.
Image<float> FillHoles(const Image<float>& depth, const HoleOptions& options);

}  // namespace vismap::naive
