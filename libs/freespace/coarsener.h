#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "freespace/cell_overlaps.h"
#include "freespace/coarsen.h"

namespace vismap {

/// Keeps a coarser map up to date while the finer one changes, equal to Coarsen of the whole map.
///
/// With the usual options, cells of 4 to 16 voxels that are free only when all of their voxels are,
/// it remembers of every block what it says of the cells that it touches, in 8 bytes. So only
/// blocks that changed are read, and most changes of voxels change no cell and end there.
class Coarsener {
 public:
  /// `voxel_size` [m].
  Coarsener(double voxel_size, const CoarsenOptions& options);

  /// Must be called with the blocks of `fine` that may have changed since the last call, at first
  /// with all of them. Returns the blocks of coarse() that changed. Throws std::logic_error on
  /// another voxel size.
  OccupancyDelta Update(const OccupancyMap& fine, std::span<const BlockIndex> changed);

  const OccupancyMap& coarse() const { return coarse_; }

 private:
  /// What a block says of the up to 3 x 3 x 3 cells that it touches, x fastest: bits 0-26 = some
  /// voxel is occupied, bits 32-58 = all of its voxels are free. 0 = unknown everywhere.
  using Parts = uint64_t;

  bool remembers_parts() const { return !overlaps_.empty(); }
  Parts PartsOf(BlockIndex index, const BlockOccupancy& block) const;
  std::vector<BlockIndex> TakeParts(const OccupancyMap& fine, std::span<const BlockIndex> changed);
  BlockOccupancy Assemble(const std::vector<Parts>& parts) const;

  double voxel_size_;
  CoarsenOptions options_;
  std::vector<Overlaps> overlaps_;        // by position of a block along an axis
  BlockTable<std::vector<Parts>> parts_;  // by coarse block, of the blocks in it, x fastest
  OccupancyMap coarse_;
};

}  // namespace vismap
