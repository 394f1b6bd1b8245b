#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/camera.h"
#include "geometry/image.h"

namespace vismap {

/// A vector per pixel, stored as one image per coordinate so that loops over rows vectorise. NaN =
/// none.
struct VectorImage {
  Image<float> x, y, z;

  Eigen::Vector3f at(int v, int u) const { return {x(v, u), y(v, u), z(v, u)}; }
  bool valid(int v, int u) const { return z(v, u) == z(v, u); }
};

/// Bits of SurfaceMap::joined.
inline constexpr uint8_t kJoinedRight = 1;  ///< one surface with pixel (u + 1, v)
inline constexpr uint8_t kJoinedDown = 2;   ///< one surface with pixel (u, v + 1)

/// How many pixels a pixel reaches in each direction without crossing a depth jump, at most its
/// radius [px].
struct PixelReach {
  Image<uint8_t> left, right, up, down;
};

/// Back-projected depth image with normals, HxW. Points and normals are NaN where there is no
/// depth; normals also where the neighbourhood does not define a plane.
struct SurfaceMap {
  VectorImage points_C;       ///< [m], camera frame
  VectorImage normals_C;      ///< unit length, toward the camera: n . p <= 0
  Image<float> normal_sigma;  ///< standard deviation of the normal [rad]; NaN without a normal
  Image<float> depth_sigma;   ///< standard deviation of the depth [m]; 0 without depth
  Image<uint8_t> joined;      ///< kJoined bits: no depth jump between the two pixels
  Image<uint8_t> radius;      ///< of the window for the normal [px]; 0 without depth
  PixelReach reach;
};

}  // namespace vismap
