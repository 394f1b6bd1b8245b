#pragma once

#include "geometry/surface.h"

namespace vismap {

/// Rows of an image that a thread processes at a time while a surface is computed.
inline constexpr size_t kSurfaceRowGrain = 8;

/// Inverse depth [1/m] and its standard deviation; both 0 = no return.
struct InverseDepth {
  Image<float> w, sigma;
};

/// Computes normals_C and normal_sigma of a surface whose reach is given. Around every pixel, a
/// plane is fitted to the inverse depth, in which planes are linear: w = a u + b v + c. The window
/// has the rows that the pixel reaches in its column, and of each row what the pixel in that column
/// reaches, so that no window crosses a depth jump. `correlation` = length over which the noise of
/// neighbouring pixels is correlated [px]. The cost per pixel grows with the window's radius, not
/// with its area.
void FitNormals(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
                SurfaceMap* surface);

}  // namespace vismap
