#pragma once

#include "meshing/block_views.h"

namespace vismap {

/// The cells of a block with from <= index < to along each axis.
struct CellBox {
  struct Range {
    int from = 0, to = kBlockSide;
  };
  Range x, y, z;
};
/// The smallest box around some cells; there must be at least one.
CellBox BoxAround(const CellBits& cells);

/// Finds the cells of the walk's block whose eight corners were all observed, some in front of the
/// surface and some behind it. Returns false when there are none; then `cells` is not set.
bool FindSurfaceCells(const NeighbourWalk& walk, CellBits* cells);

}  // namespace vismap
