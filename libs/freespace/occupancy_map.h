#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy.h"
#include "freespace/occupancy_digest.h"
#include "map/semantic_map.h"

namespace vismap {

/// The changes of an OccupancyMap, or all of it.
struct OccupancyDelta {
  double voxel_size = 0;  ///< [m]
  bool complete = false;  ///< true = blocks that are not listed are unknown
  /// Ascending by index. A block may have become unknown everywhere.
  std::vector<std::pair<BlockIndex, BlockOccupancy>> blocks;
  friend bool operator==(const OccupancyDelta&, const OccupancyDelta&) = default;
};

/// The cells with min <= cell < max along each axis.
struct OccupancyBox {
  VoxelIndex min, max;
  friend bool operator==(const OccupancyBox&, const OccupancyBox&) = default;
};

/// Extends a box so that it contains `more`; nullopt is the empty box.
void Extend(const OccupancyBox& more, std::optional<OccupancyBox>* box);

/// The smallest box around the cells of a block that are not unknown; there must be at least one.
OccupancyBox KnownCellsOf(BlockIndex index, const BlockOccupancy& occupancy);

/// How many cells of a map are free, and how many are occupied.
struct CellCounts {
  int64_t free = 0, occupied = 0;
};

/// Occupancy of a whole map in blocks of 8x8x8 cells. A cell is a voxel of the map, or a larger
/// cube after Coarsen. Updated from a SemanticMap, or by the deltas of another OccupancyMap.
class OccupancyMap {
 public:
  /// `cell_size` [m].
  explicit OccupancyMap(double cell_size) : cell_size_(cell_size) {}

  double cell_size() const { return cell_size_; }
  size_t size() const { return blocks_.size(); }  ///< blocks that are not unknown everywhere
  const BlockTable<BlockOccupancy>& blocks() const { return blocks_; }
  std::vector<BlockIndex> SortedIndices() const { return blocks_.SortedIndices(); }

  const BlockOccupancy& At(BlockIndex index) const;
  CellState At(VoxelIndex cell) const { return At(BlockOf(cell)).At(OffsetInBlock(cell)); }
  /// The state of the cell that contains a point [m].
  CellState At(const Eigen::Vector3d& p_W) const;

  /// Returns whether this changed the block.
  bool Set(BlockIndex index, const BlockOccupancy& occupancy);

  /// Classifies the given blocks of the map and returns those that changed. Throws std::logic_error
  /// when the voxel sizes differ.
  OccupancyDelta Update(const SemanticMap& map, std::span<const BlockIndex> changed,
                        const OccupancyOptions& options);

  /// Applies a delta of another OccupancyMap. Fails when it has another voxel size and is not
  /// complete.
  Result<void> Apply(const OccupancyDelta& delta);

  /// Memory of the map [bytes], about; takes constant time.
  size_t bytes() const { return blocks_.bytes() + mixed_ * kMixedBytes; }
  /// Memory of a block that is not uniform besides its entry in the table [bytes].
  static constexpr size_t kMixedBytes = sizeof(OccupancyPlanes) + 32;

  /// Digest of the content, 32 hexadecimal digits; takes constant time.
  std::string Digest() const { return digest_.Hex(cell_size_); }

  /// The smallest box around all cells that are not unknown; nullopt when there are none.
  std::optional<OccupancyBox> KnownCells() const;

 private:
  double cell_size_;
  BlockTable<BlockOccupancy> blocks_;
  size_t mixed_ = 0;  // blocks that are not uniform
  OccupancyDigest digest_;
};

/// The occupancy of the given blocks of a map.
OccupancyDelta ClassifyBlocks(const SemanticMap& map, std::span<const BlockIndex> blocks,
                              const OccupancyOptions& options);

/// The occupancy of a whole map.
OccupancyMap ClassifyMap(const SemanticMap& map, const OccupancyOptions& options);

CellCounts CountCells(const OccupancyMap& map);

}  // namespace vismap
