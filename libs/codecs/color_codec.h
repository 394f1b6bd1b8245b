#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/image.h"

namespace vismap {

/// Default upper bound on the pixels of an image that a decoder will make: enough for 4096 x 4096.
inline constexpr size_t kMaxDecodedPixels = size_t{1} << 24;

/// Width and height [px] as the JPEG header states them; nothing is decoded.
struct JpegSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const JpegSize&, const JpegSize&) = default;
};

/// Reads the size from a JPEG header. Fails when the bytes do not begin like a JPEG.
Result<JpegSize> ReadJpegSize(std::span<const uint8_t> bytes);

/// Decodes a JPEG (baseline or progressive, grey or colour) to RGB, the same bits on every machine.
/// `width`, `height` [px] = the size it must have, 0 = any. Fails, before any pixel is allocated,
/// on another size or on more than `max_pixels`; fails on truncated or corrupt data, never guesses
/// the rest.
Result<Image<Rgb8>> DecodeJpeg(std::span<const uint8_t> bytes, int width = 0, int height = 0,
                               size_t max_pixels = kMaxDecodedPixels);

/// Encodes RGB as baseline JPEG 4:2:0; `quality` in [1, 100]. The same image gives the same bytes.
/// `image` must not be empty nor larger than 65500 px each way.
std::vector<uint8_t> EncodeJpeg(const Image<Rgb8>& image, int quality = 95);

}  // namespace vismap
