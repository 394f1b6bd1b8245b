#pragma once

#include <cstdint>

#include "geometry/camera.h"
#include "geometry/image.h"
#include "geometry/pose.h"

namespace vismap {

/// A depth camera next to the colour camera.
struct DepthSource {
  PinholeCamera camera;           ///< intrinsics of the recorded depth images
  Pose T_C_D = Pose::Identity();  ///< from the depth camera D to the colour camera C
};

/// Registers a depth image to the colour camera: every return is projected to a pixel of `color`,
/// where the nearest one wins. Pixels without a return are 0, for example beside the borders of
/// near objects. `depth` has the size of `from.camera` and steps of `depth_unit_m` metres; 0 and
/// 65535 = no return. The result has the size of `color` and the same steps. Depths above 65534
/// steps are dropped.
Image<uint16_t> RegisterDepth(const Image<uint16_t>& depth, double depth_unit_m,
                              const DepthSource& from, const PinholeCamera& color);

}  // namespace vismap
