#pragma once

#include <cstdint>

#include "geometry/image.h"

namespace vismap {

/// Draws a mask over a picture: its inside tinted, and an outline. The mask is stretched to the
/// picture's size and its edges are smoothed.
void DrawMask(const Image<uint8_t>& mask, Rgb8 color, Image<Rgb8>* picture);
/// Draws a thin line inside the edge of the mask, which has the picture's size.
void DrawOutline(const Image<uint8_t>& mask, Rgb8 color, Image<Rgb8>* picture);

/// Averages squares of `factor` x `factor` pixels; what is left over at the right and at the bottom
/// is left out. The factor is at most the shorter side.
Image<Rgb8> ShrinkPicture(const Image<Rgb8>& picture, int factor);

}  // namespace vismap
