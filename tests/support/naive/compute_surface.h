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

/// Sums of some 400 inverse depths in float, of which slopes are small differences: 4e-4 is the
/// largest that was seen on recorded frames. Sensors' normals err by a hundred times that.
inline constexpr float kMaxNormalError = 6e-4F;

}  // namespace vismap::naive
