#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace vismap {

/// One zstd frame (level 1) with its content size and checksum. The same bytes and the same zstd
/// version give the same code.
std::vector<uint8_t> CompressBytes(std::span<const uint8_t> bytes);

/// Inverse of CompressBytes. Fails, before allocating, when the frame does not state a content size
/// in [min_size, max_size]; fails on damage, truncation and trailing bytes.
Result<std::vector<uint8_t>> DecompressBytes(std::span<const uint8_t> bytes, size_t min_size,
                                             size_t max_size);

/// Fails unless width and height are positive and at most `max_pixels` together: the guard that
/// stands before every allocation of a decoder.
Result<size_t> CheckedPixels(int width, int height, size_t max_pixels);

}  // namespace vismap
