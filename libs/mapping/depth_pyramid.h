#pragma once

#include <vector>

#include "geometry/image.h"

namespace vismap {

/// Nearest and farthest depth in a rectangle of pixels.
struct DepthRange {
  float nearest = 0;      ///< [m]; +infinity when no pixel is valid
  float farthest = 0;     ///< [m]; -infinity when no pixel is valid
  bool complete = false;  ///< every pixel of the rectangle has a depth
};

/// Minimum and maximum of a depth image over tiles of 4x4 pixels, 8x8 pixels, and so on: bounds the
/// depth in any rectangle by reading at most 25 tiles.
class DepthPyramid {
 public:
  /// `depth`: height x width [m], NaN = no return.
  explicit DepthPyramid(const Image<float>& depth);

  /// Bounds of the depth in columns u0 to u1 and rows v0 to v1, all of them included, which must
  /// lie in the image. The bounds may include pixels nearby.
  DepthRange Bound(int u0, int v0, int u1, int v1) const;

  /// Pixel (u, v) lies in the tile in row v >> kTileShift and column u >> kTileShift.
  static constexpr int kTileShift = 2;
  const Image<DepthRange>& tiles() const { return levels_.front(); }

 private:
  std::vector<Image<DepthRange>> levels_;
};

}  // namespace vismap
