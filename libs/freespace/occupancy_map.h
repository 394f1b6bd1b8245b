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

/// What changed in an OccupancyMap, or all of it.
struct OccupancyDelta {
  double voxel_size = 0;  ///< [m]
  bool complete = false;  ///< blocks that are not listed are unknown
  /// Ascending by index; uniform unknown = nothing is known of the block any more.
  std::vector<std::pair<BlockIndex, BlockOccupancy>> blocks;
  friend bool operator==(const OccupancyDelta&, const OccupancyDelta&) = default;
};

/// Cells min <= cell < max along each axis.
struct OccupancyBox {
  VoxelIndex min, max;
  friend bool operator==(const OccupancyBox&, const OccupancyBox&) = default;
};

/// Grows a box so that it holds another; none holds nothing.
void Extend(const OccupancyBox& more, std::optional<OccupancyBox>* box);

/// The smallest box around the cells of a block that are not unknown, which there must be.
OccupancyBox KnownCellsOf(BlockIndex index, const BlockOccupancy& occupancy);

/// Occupancy of the whole map, by blocks of 8x8x8 cells. A cell is a voxel of the map, or a larger
/// cube where a coarser map was made of it. Kept up to date by deltas: from a SemanticMap in the
/// same process, or from another process.
class OccupancyMap {
 public:
  /// `cell_size` [m].
  explicit OccupancyMap(double cell_size) : cell_size_(cell_size) {}

  double cell_size() const { return cell_size_; }
  size_t size() const { return blocks_.size(); }  ///< blocks of which anything is known
  const BlockTable<BlockOccupancy>& blocks() const { return blocks_; }
  std::vector<BlockIndex> SortedIndices() const { return blocks_.SortedIndices(); }

  const BlockOccupancy& At(BlockIndex index) const;
  CellState At(VoxelIndex cell) const { return At(BlockOf(cell)).At(OffsetInBlock(cell)); }
  /// The cell that contains a point [m].
  CellState At(const Eigen::Vector3d& p_W) const;

  /// Returns whether the block was different before.
  bool Set(BlockIndex index, const BlockOccupancy& occupancy);

  /// Classifies the given blocks of the map again and returns those that turned out different.
  /// Throws when the voxel sizes differ.
  OccupancyDelta Update(const SemanticMap& map, std::span<const BlockIndex> changed,
                        const OccupancyOptions& options);

  /// Takes over a delta made by another OccupancyMap. Fails when it is of another voxel size,
  /// unless it is complete.
  Result<void> Apply(const OccupancyDelta& delta);

  /// 32 hexadecimal digits: equal for equal content, whatever way it came about. Constant time.
  std::string Digest() const { return digest_.Hex(cell_size_); }

  /// The smallest box around all cells that are not unknown; nullopt when there are none.
  std::optional<OccupancyBox> KnownCells() const;

 private:
  double cell_size_;
  BlockTable<BlockOccupancy> blocks_;
  OccupancyDigest digest_;
};

/// What is known of each of the given blocks of a map.
OccupancyDelta ClassifyBlocks(const SemanticMap& map, std::span<const BlockIndex> blocks,
                              const OccupancyOptions& options);

/// The occupancy of all of a map.
OccupancyMap ClassifyMap(const SemanticMap& map, const OccupancyOptions& options);

}  // namespace vismap
