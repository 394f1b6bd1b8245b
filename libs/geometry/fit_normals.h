#pragma once

#include "geometry/surface.h"

namespace vismap {

/// Rows of an image that a thread takes at a time while a surface is computed.
inline constexpr size_t kSurfaceRowGrain = 8;

/// Inverse depth [1/m] and its standard deviation; both 0 = no return.
struct InverseDepth {
  Image<float> w, sigma;
};

/// Fits a plane w = a u + b v + c to the inverse depth around every pixel, over the rows it reaches
/// in its column and in each of them over what that row's pixel reaches (so no window crosses a
/// depth jump), and turns it into normals and normal_sigma of a surface whose reach is given.
/// `correlation` is the noise's [px]. The cost per pixel grows with the window's radius, not its
/// area.
void FitNormals(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
                SurfaceMap* surface);

}  // namespace vismap
