#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "map/voxel_map.h"

namespace vismap::mapfile {

using IndexedBlock = std::pair<BlockIndex, Block>;

/// How many of the blocks, from the first one on, go into one chunk: about half a megabyte, which
/// compresses well and gives all threads work. Depends on the blocks only.
size_t ChunkLength(const VoxelMap& map, std::span<const BlockIndex> indices);

/// Blocks as bytes that compress well: the indices of all blocks, then their kinds, then each field
/// of the voxels for all blocks.
std::vector<uint8_t> EncodeBlocks(const VoxelMap& map, std::span<const BlockIndex> indices);

/// Inverse of EncodeBlocks for this number of `blocks`. `labels`: number of labels of the map;
/// votes must be for these. Fails on everything that EncodeBlocks cannot have written.
Result<std::vector<IndexedBlock>> DecodeBlocks(std::span<const uint8_t> bytes, size_t blocks,
                                               size_t labels);

/// The hits of thin things in the blocks: for each block that has any, its number in `indices` (4
/// bytes), how many voxels have hits (2 bytes), and of each its offset (2 bytes) and hits (1 byte),
/// both ascending.
std::string EncodeThin(const VoxelMap& map, std::span<const BlockIndex> indices);

/// Inverse of EncodeThin for the blocks of a chunk. Fails on everything that EncodeThin cannot have
/// written.
Result<void> DecodeThin(std::span<const uint8_t> bytes, std::vector<IndexedBlock>* blocks);

}  // namespace vismap::mapfile
