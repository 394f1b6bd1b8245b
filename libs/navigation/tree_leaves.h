#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Trees that cover more blocks of 8x8x8 leaves are not read.
inline constexpr int64_t kMostTreeBlocks = 1 << 20;

/// The leaves of a `.bt` stream as the cells of a map. What has no node is unknown; in a closed
/// tree unknown space is occupied. `name` begins the message of an error. Fails as CheckOctree, and
/// when the tree covers more than kMostTreeBlocks blocks.
Result<OccupancyMap> ReadTreeLeaves(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace vismap
