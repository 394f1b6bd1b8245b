#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Compresses a delta for messages and files. The same delta gives the same bytes.
std::vector<uint8_t> EncodeOccupancyDelta(const OccupancyDelta& delta);

/// The largest size of a delta of so many blocks before compression [bytes].
size_t MaxOccupancyDeltaBytes(size_t blocks);

/// Inverse of EncodeOccupancyDelta. Safe for bytes from any source: fails unless they are a valid
/// delta, with ascending indices in range, no voxel both free and occupied, and no bytes missing or
/// left over. Decompresses at most `max_decoded_bytes`.
Result<OccupancyDelta> DecodeOccupancyDelta(std::span<const uint8_t> bytes,
                                            size_t max_decoded_bytes = size_t{1} << 28);

}  // namespace vismap
