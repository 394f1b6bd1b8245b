#pragma once

#include <array>

#include "map/surface_reader.h"
#include "meshing/block_views.h"
#include "meshing/lattice_edge.h"
#include "meshing/mesh_kernels.h"
#include "meshing/surface_cells.h"

namespace vismap {

/// The distances of one block and of a rim around it, one voxel below and two above, copied from up
/// to 27 blocks: all voxels that the mesh of the block's cells depends on. Coordinates are local to
/// the block, -1..9.
class CellGrid {
 public:
  /// Prefetches what Fill will read first of a block.
  static void Prefetch(const SurfaceVoxels& voxels);
  /// Copies the distances that some cells of the walk's block depend on. All neighbours of the
  /// block must have been found. Valid as long as what `reader` has read.
  void Fill(const NeighbourWalk& walk, const CellBox& cells, SurfaceReader* reader);

  /// The distance at the lower end of an edge, see EdgeSlot. That at the upper end is AxisStep
  /// behind it.
  const int16_t* Lower(size_t slot) const {
    return &distances_[slot % kAxisSlots + static_cast<size_t>(GridOffset(0, 0, 0))];
  }

  /// The surface voxels of a block, nullptr for a free or unseen block, and the offset of a voxel.
  struct Place {
    const SurfaceVoxels* voxels = nullptr;
    int offset = 0;
  };
  /// The place of the voxel at an end of an edge, see LocateEnds.
  Place PlaceOfEnd(uint32_t end) const {
    return {upper_voxels_[end >> kEndBits], static_cast<uint16_t>(end)};
  }
  /// The place of voxel (x, y, z).
  Place PlaceOf(int x, int y, int z) const {
    return {voxels_[NeighbourSlot(x >> 3, y >> 3, z >> 3)], LinearIndex(x & 7, y & 7, z & 7)};
  }

 private:
  std::array<const SurfaceVoxels*, 27> voxels_{};
  // Of the block at (i & 1, i >> 1 & 1, i >> 2).
  std::array<const SurfaceVoxels*, 8> upper_voxels_{};
  DistanceGrid distances_;
};

}  // namespace vismap
