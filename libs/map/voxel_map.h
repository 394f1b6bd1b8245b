#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "map/block_table.h"

namespace vismap {

/// Geometry of the voxel grid; fixed for the life of a map.
struct VoxelGridOptions {
  double voxel_size = 0.01;  ///< edge of a voxel [m]
  double truncation_voxels =
      4.0;  ///< truncation distance in voxels; at least 3, or free space cannot be told
};

/// Sparse map of blocks: the TSDF, the label votes and the free space. Holds no policy: see
/// mapping/ for what changes it.
class VoxelMap {
 public:
  explicit VoxelMap(const VoxelGridOptions& options) : options_(options) {}

  double voxel_size() const { return options_.voxel_size; }
  double block_size() const { return options_.voxel_size * kBlockSide; }
  double truncation() const { return options_.truncation_voxels * options_.voxel_size; }
  const VoxelGridOptions& options() const { return options_; }

  /// The block, or nullptr where nothing was ever seen.
  const Block* Find(BlockIndex index) const { return blocks_.Find(index); }
  /// Finds one block after the other, faster where neighbours follow each other.
  using Reader = BlockTable<Block>::Reader;
  Reader reader() const { return Reader(blocks_); }
  /// Block at `index`, created empty (unseen) when missing. Not thread-safe.
  Block& FindOrCreate(BlockIndex index) { return blocks_.FindOrCreate(index); }
  Block* FindMutable(BlockIndex index) { return blocks_.Find(index); }
  void Erase(BlockIndex index) { blocks_.Erase(index); }
  void Clear() {
    blocks_.Clear();
    unpacked_.clear();
  }

  /// Notes that the surface of a block was looked at by revision `now`, which is at least 1.
  void NoteUse(BlockIndex index, Block& block, uint32_t now);
  /// Packs blocks that nobody looked at since `before`, some at a time, while more than `most` are
  /// unpacked. What the map says stays the same.
  void PackUnused(uint32_t before, size_t most);

  size_t size() const { return blocks_.size(); }
  const BlockTable<Block>& blocks() const { return blocks_; }
  /// All block indices in ascending (x, y, z) order.
  std::vector<BlockIndex> SortedIndices() const { return blocks_.SortedIndices(); }

 private:
  VoxelGridOptions options_;
  BlockTable<Block> blocks_;
  std::vector<BlockIndex> unpacked_;  // those with last_used > 0; no order that means anything
  size_t next_to_pack_ = 0;           // place in it where PackUnused goes on
};

/// Bytes held per layer, as `info` and report.json show them.
struct VoxelMapMemory {
  size_t surface_blocks = 0, free_blocks = 0, all_free_blocks = 0;
  size_t packed_blocks = 0;                                 ///< of the surface blocks
  size_t tsdf_bytes = 0, color_bytes = 0, label_bytes = 0;  ///< of those that are not packed
  size_t packed_bytes = 0;                                  ///< all layers of the packed ones
  size_t free_bytes = 0, table_bytes = 0;
  size_t total_bytes() const {
    return tsdf_bytes + color_bytes + label_bytes + packed_bytes + free_bytes + table_bytes;
  }
};
VoxelMapMemory MeasureMemory(const VoxelMap& map);

}  // namespace vismap
