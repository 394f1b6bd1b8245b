#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/frame.h"
#include "geometry/image.h"

namespace vismap {

/// Decodes a 16-bit depth image of `width` x `height` pixels: little-endian, row by row without
/// padding. Fails on another number of bytes and on more than kMaxDecodedPixels.
Result<Image<uint16_t>> DecodeRaw16(std::span<const uint8_t> bytes, int width, int height);

/// Decodes a zlib stream of what DecodeRaw16 decodes. Fails likewise, on a damaged stream and on
/// bytes after it. Allocates no more than the image needs.
Result<Image<uint16_t>> DecodeZlib16(std::span<const uint8_t> bytes, int width, int height);

/// Decodes a depth image of 32-bit floats: little-endian, row by row without padding. What is not
/// measured (NaN, infinity, values <= 0, and above 65534 m) becomes NaN. Fails as DecodeRaw16 does.
Result<Image<float>> DecodeRawFloat(std::span<const uint8_t> bytes, int width, int height);

/// The bytes that DecodeRawFloat decodes.
std::vector<uint8_t> EncodeRawFloat(const Image<float>& depth_m);

/// Fails unless bytes that begin an image in `encoding` are those of one with `width` x `height`
/// pixels. Nothing is decoded. A JPEG or PNG whose header is damaged does not fail: decoding it
/// does.
Result<void> CheckColorSize(ColorEncoding encoding, std::span<const uint8_t> bytes, int width,
                            int height);

/// Decodes a colour image of `width` x `height` pixels. Fails on another size before memory is
/// allocated, and on damaged data.
Result<Image<Rgb8>> DecodeColor(ColorEncoding encoding, std::span<const uint8_t> bytes, int width,
                                int height);

}  // namespace vismap
