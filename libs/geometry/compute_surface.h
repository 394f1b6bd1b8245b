#pragma once

#include "geometry/surface.h"
#include "geometry/surface_options.h"

namespace vismap {

/// Back-projects a depth image (HxW [m] along z; NaN, infinite or out of the options' range = no
/// return) and estimates normals. A plane is linear in inverse depth, 1/z = a u + b v + c, and a
/// disparity sensor's noise is constant in it; so the fit is a linear least squares whose window
/// needs no slope compensation, and whose cost per pixel does not depend on the depth. Windows grow
/// with the noise and never reach across a depth jump. Throws when the image is not the camera's.
SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options);

}  // namespace vismap
