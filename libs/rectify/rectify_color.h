#pragma once

#include <cstdint>

#include "geometry/image.h"
#include "geometry/optics.h"

namespace vismap {

/// Where a pixel of the rectified image lies in the colour image, in 1/256 px.
struct ColorSource {
  int32_t x = 0;
  int32_t y = 0;
};

/// What is computed once per camera to rectify its colour.
struct ColorTable {
  int width = 0, height = 0;   ///< of the colour image [px]
  int halvings = 0;            ///< how often the image is halved before it is sampled
  Image<ColorSource> sources;  ///< HxW of the result; within the halved image
};

/// The table for colour of the camera `from`, seen from a camera `target` at the same pose. A pixel
/// that the lens does not show has the colour of the nearest pixel at the border.
ColorTable MakeColorTable(const LensCamera& from, const PinholeCamera& target);

/// Colour as the target camera of the table sees it, interpolated linearly. The image is halved as
/// often as the result has fewer than half of its pixels along a side, so that fine patterns do not
/// flicker. `color` has the size of the table.
Image<Rgb8> RectifyColor(const Image<Rgb8>& color, const ColorTable& table);

}  // namespace vismap
