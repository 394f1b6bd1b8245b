#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "geometry/camera.h"
#include "geometry/image.h"

namespace vismap {

/// Default limit of the number of pixels of a decoded image.
inline constexpr size_t kMaxDecodedPixels = kMaxImagePixels;

/// Width and height [px] as the JPEG header states them; nothing is decoded.
struct JpegSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const JpegSize&, const JpegSize&) = default;
};

/// Reads the size from a JPEG header. Fails when the bytes do not begin like a JPEG.
Result<JpegSize> ReadJpegSize(std::span<const uint8_t> bytes);

/// Whether the bytes of a JPEG have its end, perhaps followed by others. Without it, the file was
/// cut off.
bool HasJpegEnd(std::span<const uint8_t> bytes);

/// Decodes a JPEG (baseline or progressive, grey, colour or CMYK) to RGB, the same bits on every
/// machine. `width`, `height`: the size that it must have [px], 0 = any. Fails before memory is
/// allocated on another size and on more than `max_pixels`. Fails on data that is cut off instead
/// of filling in the rest. Of data that is damaged but whole, it returns what can be decoded.
Result<Image<Rgb8>> DecodeJpeg(std::span<const uint8_t> bytes, int width = 0, int height = 0,
                               size_t max_pixels = kMaxDecodedPixels);

/// Encodes RGB as baseline JPEG 4:2:0; `quality` in [1, 100]. The same image gives the same bytes.
/// Width and height of `image` must be 1..65500.
std::vector<uint8_t> EncodeJpeg(const Image<Rgb8>& image, int quality = 95);

}  // namespace vismap
