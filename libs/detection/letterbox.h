#pragma once

#include "detection/box.h"

namespace vismap {

/// How an image is laid into the input of a network: resized with its aspect kept, at the top left;
/// the rest at the right or bottom is padding.
struct Letterbox {
  int image_width = 0, image_height = 0;  ///< [px]
  int input_width = 0, input_height = 0;  ///< of the whole input [px]
  int width = 0, height = 0;              ///< of the resized image in the input [px]

  /// Input pixels per image pixel.
  double scale_u() const { return static_cast<double>(width) / image_width; }
  double scale_v() const { return static_cast<double>(height) / image_height; }
};

/// All sizes must be positive. The resized image has at least one pixel each way.
Letterbox FitLetterbox(int image_width, int image_height, int input_width, int input_height);

/// A box in input pixels as one in image pixels, cut at the edges of the image. Edges that are not
/// numbers give an empty box.
Box ToImage(const Letterbox& letterbox, const Box& in_input);

}  // namespace vismap
