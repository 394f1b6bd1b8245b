#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "map/block.h"

namespace vismap {

// Where the voxels of blocks lie among the larger cells of a coarser map, see coarsen.h. A block of
// the coarser map is made of factor^3 blocks; the position of one among these is 0..factor-1 along
// each axis.

/// The part of a block's eight voxels along one axis that lies in one cell.
struct CellOverlap {
  int cell = 0;   ///< 0..7 in the coarse block
  int begin = 0;  ///< first voxel, 0..7
  int count = 0;
  uint64_t mask = 0;  ///< the voxels, as bits 0..7
  uint64_t rows = 0;  ///< the same for rows of a layer: eight bits for each
};

/// The cells that block `position` (0..factor-1) of a coarse block touches along one axis. Limits
/// of cells and of blocks need not coincide.
struct Overlaps {
  std::array<CellOverlap, kBlockSide> items;
  size_t size = 0;
  const CellOverlap* begin() const { return items.data(); }
  const CellOverlap* end() const { return items.data() + size; }
};

inline Overlaps OverlapsAt(int position, int factor) {
  Overlaps overlaps;
  for (int voxel = 0; voxel < kBlockSide; ++voxel) {
    const int cell = (kBlockSide * position + voxel) / factor;
    if (overlaps.size == 0 || overlaps.items[overlaps.size - 1].cell != cell) {
      overlaps.items[overlaps.size++] = {cell, voxel, 0, 0, 0};
    }
    CellOverlap& last = overlaps.items[overlaps.size - 1];
    ++last.count;
    last.mask |= uint64_t{1} << voxel;
    last.rows |= uint64_t{0xff} << (8 * voxel);
  }
  return overlaps;
}

/// The cells that a block touches in a layer.
inline uint64_t CellsOf(const Overlaps& xs, const Overlaps& ys) {
  uint64_t row = 0, cells = 0;
  for (const CellOverlap& x : xs) row |= uint64_t{1} << x.cell;
  for (const CellOverlap& y : ys) cells |= row << (kBlockSide * y.cell);
  return cells;
}

/// The largest integer that is at most a / b, of b > 0.
template <typename Integer>
constexpr Integer FloorDivide(Integer a, Integer b) {
  return a / b - (a % b < 0 ? 1 : 0);
}

inline BlockIndex CoarseIndex(BlockIndex fine, int factor) {
  return {FloorDivide(fine.x, factor), FloorDivide(fine.y, factor), FloorDivide(fine.z, factor)};
}

/// The coarse blocks that some blocks lie in, ascending.
inline std::vector<BlockIndex> CoarseBlocksOf(std::span<const BlockIndex> blocks, int factor) {
  std::vector<BlockIndex> coarse;
  for (const BlockIndex& block : blocks) {
    const BlockIndex index = CoarseIndex(block, factor);
    if (coarse.empty() || coarse.back() != index) coarse.push_back(index);
  }
  std::sort(coarse.begin(), coarse.end());
  coarse.erase(std::unique(coarse.begin(), coarse.end()), coarse.end());
  return coarse;
}

}  // namespace vismap
