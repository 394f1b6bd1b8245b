#pragma once

#include <vector>

#include "geometry/image.h"

namespace vismap {

/// Nearest and farthest depth over a rectangle of pixels.
struct DepthRange {
  float nearest = 0;      ///< [m]; +infinity when no pixel is valid
  float farthest = 0;     ///< [m]; -infinity when no pixel is valid
  bool complete = false;  ///< every pixel of the rectangle has a depth
};

/// Minimum and maximum of a depth image over 4x4-pixel tiles and their powers of two: bounds the
/// depth in any rectangle by looking at no more than 25 tiles.
class DepthPyramid {
 public:
  /// `depth` in metres, NaN = no return.
  explicit DepthPyramid(const Image<float>& depth);

  /// Bounds over the pixels [u0, u1] x [v0, v1], which must lie in the image. Conservative: pixels
  /// nearby may be included.
  DepthRange Bound(int u0, int v0, int u1, int v1) const;

  /// Pixels (u, v) lie in tile (v >> kTileShift, u >> kTileShift).
  static constexpr int kTileShift = 2;
  const Image<DepthRange>& tiles() const { return levels_.front(); }

 private:
  std::vector<Image<DepthRange>> levels_;
};

}  // namespace vismap
