#pragma once

#include <cstdint>
#include <vector>

namespace vismap {

/// PNG bytes of a one-channel image filled with one value; 8 or 16 bits.
std::vector<uint8_t> GreyPng(int width, int height, int value, int bits = 16);
/// PNG bytes of a colour image, red left of the middle, green right of it; 8 or 16 bits.
std::vector<uint8_t> ColorPng(int width, int height, int bits = 8);
/// JPEG bytes of the same picture.
std::vector<uint8_t> ColorJpeg(int width, int height);

}  // namespace vismap
