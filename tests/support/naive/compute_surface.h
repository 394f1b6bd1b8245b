#pragma once

#include "geometry/surface.h"
#include "geometry/surface_options.h"

namespace vismap::naive {

/// ComputeSurface with kInverseDepthFit, one pixel at a time: each walks to what it reaches and
/// sums over its own window. Points, radius, joined, reach and depth_sigma have the same bits as
/// the fast one's. Normals are summed in double where the fast one sums in float: which pixels have
/// one is the same, components differ by less than kMaxNormalError and normal_sigma by less than
/// that part of itself.
SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options);

/// Differences of slope and inverse depth from sums of at most 63 x 63 floats, with a window of
/// radius 2 at 0.1 m as the worst case: 3 * 6e-8 * f / 2 [rad], times a few.
inline constexpr float kMaxNormalError = 5e-4F;

}  // namespace vismap::naive
