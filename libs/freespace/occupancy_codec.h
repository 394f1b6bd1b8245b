#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// The delta as compressed bytes, for messages and files. The same delta gives the same bytes.
std::vector<uint8_t> EncodeOccupancyDelta(const OccupancyDelta& delta);

/// Bytes that a delta of so many blocks has at most before compression.
size_t MaxOccupancyDeltaBytes(size_t blocks);

/// Safe on bytes from anywhere: whatever does not decode to a valid delta (indices ascending and in
/// range, no voxel free and occupied, nothing missing or left over) is an error, and never more
/// than `max_decoded_bytes` are decompressed.
Result<OccupancyDelta> DecodeOccupancyDelta(std::span<const uint8_t> bytes,
                                            size_t max_decoded_bytes = size_t{1} << 28);

}  // namespace vismap
