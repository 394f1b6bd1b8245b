#pragma once

#include "detection/box.h"

namespace vismap {

/// The position of an image in the input of a network. The image is resized with its aspect ratio
/// and put at the top left; the rest at the right or at the bottom is padding.
struct Letterbox {
  int image_width = 0, image_height = 0;  ///< [px]
  int input_width = 0, input_height = 0;  ///< size of the whole input [px]
  int width = 0, height = 0;              ///< size of the resized image in the input [px]

  /// Number of input pixels per image pixel.
  double scale_u() const { return static_cast<double>(width) / image_width; }
  double scale_v() const { return static_cast<double>(height) / image_height; }
};

/// Fits an image into an input. All sizes [px] must be positive. The sides of the resized image are
/// at least one pixel.
Letterbox FitLetterbox(int image_width, int image_height, int input_width, int input_height);

/// Converts a box from input pixels to image pixels and clips it to the image. Edges that are NaN
/// become 0.
Box ToImage(const Letterbox& letterbox, const Box& in_input);

}  // namespace vismap
