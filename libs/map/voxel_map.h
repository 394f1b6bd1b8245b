#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "map/block_table.h"

namespace vismap {

/// Geometry of the voxel grid; fixed for the life of a map.
struct VoxelGridOptions {
  double voxel_size_m = 0.01;  ///< edge of a voxel [m]
  /// Truncation distance [voxels]; at least 3, or free space and surface cannot be told apart.
  double truncation_voxels = 4.0;
};

/// Sparse map of blocks: TSDF, label votes and free space. Only data: mapping/ changes it.
class VoxelMap {
 public:
  explicit VoxelMap(const VoxelGridOptions& options) : options_(options) {}

  double voxel_size() const { return options_.voxel_size_m; }
  double block_size() const { return options_.voxel_size_m * kBlockSide; }
  double truncation() const { return options_.truncation_voxels * options_.voxel_size_m; }
  const VoxelGridOptions& options() const { return options_; }

  /// The block, or nullptr when it is unseen.
  const Block* Find(BlockIndex index) const { return blocks_.Find(index); }
  /// Finds many blocks, faster than Find when neighbours follow each other.
  using Reader = BlockTable<Block>::Reader;
  Reader reader() const { return Reader(blocks_); }
  /// The block at `index`; an empty one is added when it is missing. Not thread-safe.
  Block& FindOrCreate(BlockIndex index) { return blocks_.FindOrCreate(index); }
  Block* FindMutable(BlockIndex index) { return blocks_.Find(index); }
  void Erase(BlockIndex index) { blocks_.Erase(index); }
  void Clear() {
    blocks_.Clear();
    unpacked_.clear();
    content_bytes_ = 0;
  }

  /// Records that revision `now`, at least 1, has changed the surface of a block.
  void MarkUsed(BlockIndex index, Block& block, uint32_t now);
  /// Packs blocks that were not used since revision `before`, a limited number per call, while more
  /// than `most` are unpacked. The content of the map stays the same.
  void PackUnused(uint32_t before, size_t most);

  /// Memory of the map [bytes], about; takes constant time.
  size_t bytes() const {
    return blocks_.bytes() + static_cast<size_t>(std::max<int64_t>(content_bytes_, 0));
  }
  /// Records that a block was changed, which took `before` bytes and takes `after` now, see
  /// BytesOf.
  void CountBytes(size_t before, size_t after) {
    content_bytes_ += static_cast<int64_t>(after) - static_cast<int64_t>(before);
  }

  size_t size() const { return blocks_.size(); }
  const BlockTable<Block>& blocks() const { return blocks_; }
  /// All block indices in ascending (x, y, z) order.
  std::vector<BlockIndex> SortedIndices() const { return blocks_.SortedIndices(); }

 private:
  VoxelGridOptions options_;
  BlockTable<Block> blocks_;
  std::vector<BlockIndex> unpacked_;  // blocks with last_used > 0, in any order
  size_t next_to_pack_ = 0;           // where in unpacked_ the next PackUnused begins
  int64_t content_bytes_ = 0;         // of the blocks outside of the table, see CountBytes
};

/// Memory that a block takes outside of the table [bytes], about. It depends on whether it is
/// packed.
size_t BytesOf(const Block& block);

/// Memory of a map by layer.
struct VoxelMapMemory {
  size_t surface_blocks = 0, free_blocks = 0, all_free_blocks = 0;
  size_t packed_blocks = 0;                                 ///< among surface_blocks
  size_t tsdf_bytes = 0, color_bytes = 0, label_bytes = 0;  ///< of blocks that are not packed
  size_t packed_bytes = 0;                                  ///< all layers of packed blocks
  size_t free_bytes = 0, table_bytes = 0;
  size_t total_bytes() const {
    return tsdf_bytes + color_bytes + label_bytes + packed_bytes + free_bytes + table_bytes;
  }
};
VoxelMapMemory MeasureMemory(const VoxelMap& map);

}  // namespace vismap
