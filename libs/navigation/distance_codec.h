#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/result.h"
#include "navigation/distance_field.h"

namespace vismap {

/// Distances of some blocks of a field, ascending by index; nullopt = the block is unknown
/// everywhere.
using DistanceBlocks = std::vector<std::pair<BlockIndex, std::optional<BlockDistances>>>;

/// Compresses blocks for messages, see distance_field_t. The same blocks give the same bytes.
std::vector<uint8_t> EncodeDistances(const DistanceBlocks& blocks);

/// The largest size of so many blocks before compression [bytes].
size_t MaxDistanceBytes(size_t blocks);

/// Inverse of EncodeDistances. Safe for bytes from any source: fails unless they are valid blocks,
/// with ascending indices in range, no distance above kBeyond, and no bytes missing or left over.
/// Decompresses at most `max_decoded_bytes`.
Result<DistanceBlocks> DecodeDistances(std::span<const uint8_t> bytes, size_t max_decoded_bytes);

}  // namespace vismap
