#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"

namespace vismap {

/// Compresses the bytes of a block fast. For many small pieces: each thread keeps what it needs for
/// this until it ends.
std::vector<uint8_t> CompressBlock(std::span<const uint8_t> bytes);

/// Inverse of CompressBlock, for bytes that this process has written.
Result<std::vector<uint8_t>> DecompressBlock(std::span<const uint8_t> bytes);

}  // namespace vismap
