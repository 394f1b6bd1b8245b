#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "codecs/color_codec.h"
#include "geometry/image.h"

namespace vismap {

/// Compresses a 16-bit depth image without loss. The size of the image is not part of the code. The
/// same image gives the same bytes.
std::vector<uint8_t> EncodeDepth(const Image<uint16_t>& depth);

/// Inverse of EncodeDepth for an image of `width` x `height` pixels. Fails on truncated data,
/// trailing bytes, another size and more than `max_pixels`. Allocates no more than the image needs.
Result<Image<uint16_t>> DecodeDepth(std::span<const uint8_t> bytes, int width, int height,
                                    size_t max_pixels = kMaxDecodedPixels);

}  // namespace vismap
