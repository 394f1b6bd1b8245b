#pragma once

#include <cstdint>

#include "geometry/camera.h"
#include "geometry/image.h"
#include "geometry/pose.h"

namespace vismap {

/// A depth camera beside the colour camera.
struct DepthSource {
  PinholeCamera camera;           ///< of the depth images as recorded
  Pose T_C_D = Pose::Identity();  ///< from it to the colour camera
};

/// Depth as the colour camera sees it: every return goes to the pixel of `color` that it falls on,
/// the nearest one wins; 0 where none does, such as behind the rims of near things. `depth` has the
/// size of `from.camera`, in steps of `depth_unit_m`, 0 and 65535 = no return; the result has the
/// size of `color` and the same steps. What would be beyond 65534 steps is none.
Image<uint16_t> RegisterDepth(const Image<uint16_t>& depth, double depth_unit_m,
                              const DepthSource& from, const PinholeCamera& color);

}  // namespace vismap
