#pragma once

#include "geometry/surface.h"
#include "geometry/surface_options.h"

namespace vismap::naive {

/// ComputeSurface with kInverseDepthFit, one pixel at a time: each pixel searches what it reaches
/// and sums over its own window. Points, radius, joined, reach and depth_sigma are equal to those
/// of the fast one bit for bit. Normals are summed in double here and in float there: the same
/// pixels have one, components differ by less than kMaxNormalError, and normal_sigma relatively by
/// less than that.
SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options);

/// Rounding error of sums of about 400 inverse depths in float, whose small differences are the
/// slopes. On recorded frames it was at most 4e-4, a hundredth of the error by the sensor's noise.
inline constexpr float kMaxNormalError = 6e-4F;

}  // namespace vismap::naive
