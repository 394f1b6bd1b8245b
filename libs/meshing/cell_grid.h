#pragma once

#include <array>

#include "map/surface_reader.h"
#include "meshing/block_views.h"
#include "meshing/lattice_edge.h"
#include "meshing/mesh_kernels.h"
#include "meshing/surface_cells.h"

namespace vismap {

/// The voxels of one block and a rim around it (one voxel below, two above), copied from up to 27
/// blocks: all that the surface of the block's cells depends on. Coordinates are local to the
/// block, -1..9.
class CellGrid {
 public:
  /// Asks memory for what the grid of a block will need first.
  static void Prefetch(const SurfaceVoxels& voxels);
  /// Copies what some cells of a block depend on: of the block that the walk is at, which knows all
  /// its neighbours. Good for as long as what `reader` read.
  void Fill(const NeighbourWalk& walk, const CellBox& cells, SurfaceReader* reader);

  /// The distance at the lower end of an edge, as numbered by EdgeSlot. The one at the upper end is
  /// AxisStep behind it.
  const int16_t* Lower(size_t slot) const {
    return &distances_[slot % kAxisSlots + static_cast<size_t>(GridOffset(0, 0, 0))];
  }

  /// The surface voxels that hold a voxel, and its offset there; nullptr in free or unseen blocks.
  struct Place {
    const SurfaceVoxels* voxels = nullptr;
    int offset = 0;
  };
  /// Of the voxel at an end of an edge, see LocateEnds.
  Place PlaceOfEnd(uint32_t end) const {
    return {upper_voxels_[end >> kEndBits], static_cast<uint16_t>(end)};
  }
  /// Of the voxel (x, y, z).
  Place PlaceOf(int x, int y, int z) const {
    return {voxels_[NeighbourSlot(x >> 3, y >> 3, z >> 3)], LinearIndex(x & 7, y & 7, z & 7)};
  }

 private:
  std::array<const SurfaceVoxels*, 27> voxels_{};
  std::array<const SurfaceVoxels*, 8> upper_voxels_{};  // the same, of (i & 1, i >> 1 & 1, i >> 2)
  DistanceGrid distances_;
};

}  // namespace vismap
