#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/result.h"
#include "codecs/color_codec.h"
#include "geometry/image.h"

namespace vismap {

/// What the header of a PNG states.
struct PngInfo {
  int width = 0;
  int height = 0;
  int bits = 8;       ///< per channel
  bool grey = false;  ///< one channel, without a palette
};

/// Reads the header of a PNG. Fails when the bytes do not begin like one.
Result<PngInfo> ReadPngInfo(std::span<const uint8_t> bytes);

/// Whether a PNG has its end chunk, perhaps followed by other bytes. Without it, the file was cut
/// off.
bool HasPngEnd(std::span<const uint8_t> bytes);

/// Decodes a PNG with one channel of 16 bits. `width`, `height`: the size that it must have [px], 0
/// = any. Fails on another kind, before memory is allocated on another size and on more than
/// `max_pixels`, and on data that is damaged or cut off.
Result<Image<uint16_t>> DecodePng16(std::span<const uint8_t> bytes, int width = 0, int height = 0,
                                    size_t max_pixels = kMaxDecodedPixels);

/// Decodes a PNG, colour or grey, to RGB with 8 bits. Fails like DecodePng16, but on no kind.
Result<Image<Rgb8>> DecodeColorPng(std::span<const uint8_t> bytes, int width = 0, int height = 0,
                                   size_t max_pixels = kMaxDecodedPixels);

}  // namespace vismap
