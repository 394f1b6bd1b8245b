#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "geometry/image.h"

namespace vismap {

/// Colours of the leaves of a block, by linear index.
using BlockColors = std::array<Rgb8, kBlockVoxels>;

/// The leaves of an octree. What has no node is unknown.
struct OctreeLeaves {
  OccupancyMap cells{1};  ///< cells of the size of the smallest leaves
  /// Of the blocks with occupied leaves, when the file has colours.
  std::optional<std::map<BlockIndex, BlockColors>> colors;
};

/// Trees whose leaves with colours cover more blocks of 8x8x8 leaves are not read.
inline constexpr int64_t kMostColoredBlocks = 1 << 17;

/// Reads a whole file of OctoMap: `.bt`, or `.ot` of the kind OcTree or ColorOcTree, where a leaf
/// is occupied when its log odds are positive or 0. `name` begins the message of an error. Fails on
/// other files, on damaged ones, and on trees that are too large (see kMostTreeBlocks,
/// kMostColoredBlocks).
Result<OctreeLeaves> ReadOctree(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace vismap
