#pragma once

#include "geometry/image.h"
#include "geometry/noise_model.h"
#include "mapping/depth_pyramid.h"

namespace vismap {

/// How much nearer than the measured depths space counts as clear.
struct ClearDepthOptions {
  float margin = 0.04F;  ///< at least [m]
  float sigmas = 4;      ///< and so many standard deviations of the depth
  DepthNoiseModel noise = KinectNoise();
};

/// Up to which depth space is surely empty at each pixel [m]; 0 = nothing is sure. `pyramid` is
/// that of the frame's depth. Pixels beside a nearer surface, at its edge, have the clear depth of
/// that: mixed pixels, thin things and small errors of the pose cut nothing away. A tile of 4x4
/// pixels that has one without return is not sure, nor is one beside a tile without any.
Image<float> ClearDepth(const DepthPyramid& pyramid, int width, int height,
                        const ClearDepthOptions& options);

}  // namespace vismap
