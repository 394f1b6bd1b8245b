#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/result.h"
#include "map/voxel_map.h"

namespace vismap::mapfile {

using IndexedBlock = std::pair<BlockIndex, Block>;

/// How many of the blocks from `indices` on go into one chunk: as many as make a chunk of a size
/// that compresses well and spreads over threads. Depends on nothing but the blocks.
size_t ChunkLength(const VoxelMap& map, std::span<const BlockIndex> indices);

/// Blocks as plain bytes, like beside like: indices, kinds, then field by field over all blocks.
std::vector<uint8_t> EncodeBlocks(const VoxelMap& map, std::span<const BlockIndex> indices);

/// The other way. `labels` = number of labels of the map: no vote may be for another. Fails on
/// everything that EncodeBlocks cannot have written.
Result<std::vector<IndexedBlock>> DecodeBlocks(std::span<const uint8_t> bytes, size_t blocks,
                                               size_t labels);

}  // namespace vismap::mapfile
