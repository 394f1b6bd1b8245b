#pragma once

#include "geometry/surface.h"
#include "geometry/surface_options.h"

namespace vismap {

/// Back-projects a depth image (HxW [m] along z; NaN, infinite or outside the options' range = no
/// return) and estimates normals. A plane is linear in inverse depth, 1/z = a u + b v + c, and the
/// noise of a disparity sensor is constant in it, so that normals follow from linear least squares
/// without correction for the slope. Windows grow with the noise and never cross a depth jump.
/// Throws when image and camera differ in size.
SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options);

}  // namespace vismap
