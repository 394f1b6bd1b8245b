#pragma once

#include <array>

#include "geometry/image.h"
#include "geometry/optics.h"
#include "rectify/splat_kernels.h"

namespace vismap {

/// What is computed once per camera to rectify its depth: the ray of every pixel in the axes of the
/// colour camera, multiplied by the intrinsics of the result (see RayRow).
struct DepthTable {
  PinholeCamera target;
  Image<float> rx, ry, rz;
  float tx = 0, ty = 0, tz = 0;
  PixelSteps steps;
};

/// The table for depth of the camera `from`, seen from a camera `target` at T_target_from.
DepthTable MakeDepthTable(const LensCamera& from, const Pose& T_target_from,
                          const PinholeCamera& target);

/// Depth [m] as the target camera of the table sees it; NaN = no depth. Every pixel with depth
/// covers the part of the result up to half the way to its neighbours, with the slope of the
/// surface; where two pixels cover the same one, the nearer surface is in front. Across a depth
/// jump nothing is filled in. `depth_m` has the size of the table.
Image<float> RectifyDepth(const Image<float>& depth_m, const DepthTable& table);

}  // namespace vismap
