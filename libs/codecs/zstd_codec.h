#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Compresses to one zstd frame (level 1) with content size and checksum. The same bytes and the
/// same version of zstd give the same frame.
std::vector<uint8_t> CompressBytes(std::span<const uint8_t> bytes);

/// Inverse of CompressBytes. Fails before memory is allocated when the frame does not state a
/// content size in [min_size, max_size]; fails on damaged or truncated data and on trailing bytes.
Result<std::vector<uint8_t>> DecompressBytes(std::span<const uint8_t> bytes, size_t min_size,
                                             size_t max_size);

/// width * height. Fails when one of them is not positive or the product exceeds `max_pixels`;
/// every decoder calls this before it allocates an image.
Result<size_t> CheckedPixels(int width, int height, size_t max_pixels);

}  // namespace vismap
