#pragma once

#include "meshing/block_views.h"

namespace vismap {

/// Cells of a block, from <= i < to along each axis.
struct CellBox {
  struct Range {
    int from = 0, to = kBlockSide;
  };
  Range x, y, z;
};
/// The smallest box around some cells, of which there must be one.
CellBox BoxAround(const CellBits& cells);

/// The cells whose eight corners were all observed, with some behind the surface and some before
/// it, of the block that the walk is at. False = there are none, and `cells` is not set.
bool FindSurfaceCells(const NeighbourWalk& walk, CellBits* cells);

}  // namespace vismap
