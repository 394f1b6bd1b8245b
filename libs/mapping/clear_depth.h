#pragma once

#include "geometry/image.h"
#include "geometry/noise_model.h"
#include "mapping/depth_pyramid.h"

namespace vismap {

/// How much nearer than the measured depth space must be to count as empty for sure: by the larger
/// of the two.
struct ClearDepthOptions {
  float margin = 0.04F;  ///< [m]
  float sigmas = 4;      ///< standard deviations of the depth
  DepthNoiseModel noise = KinectNoise();
};

/// The depth up to which space is surely empty, height x width [m]; 0 = none is. All pixels of a
/// tile of 4x4 have the same: the smallest depth in the tile and the eight around it, less a
/// margin. So mixed pixels at edges, thin objects and small errors of the pose carve nothing. It is
/// 0 for a tile with a pixel without return, and beside a tile without any return. `pyramid`: of
/// the frame's depth.
Image<float> ClearDepth(const DepthPyramid& pyramid, int width, int height,
                        const ClearDepthOptions& options);

}  // namespace vismap
