#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "codecs/color_codec.h"
#include "geometry/image.h"

namespace vismap {

/// Lossless code of a 16-bit depth image. The size is not part of the code: it stands in the
/// message or file beside it. The same image gives the same bytes.
std::vector<uint8_t> EncodeDepth(const Image<uint16_t>& depth);

/// Inverse of EncodeDepth for an image of `width` x `height` pixels. Fails on any other content:
/// truncated, trailing bytes, another size, more than `max_pixels`; never allocates more than the
/// image needs.
Result<Image<uint16_t>> DecodeDepth(std::span<const uint8_t> bytes, int width, int height,
                                    size_t max_pixels = kMaxDecodedPixels);

}  // namespace vismap
