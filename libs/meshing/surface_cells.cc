#include "meshing/surface_cells.h"

#include <algorithm>
#include <bit>

namespace vismap {
namespace {

constexpr std::array<uint64_t, kBlockSide> kNone{};

// The bits of the walk's block and of its upper neighbours.
LatticeBits ReadBits(const NeighbourWalk& walk, const uint64_t* BlockView::*bits) {
  LatticeBits lattice;
  for (size_t i = 0; i < lattice.size(); ++i) {
    const auto at = [&](int z) {
      const int x = static_cast<int>(i & 1), y = static_cast<int>(i >> 1);
      const uint64_t* words = walk.At(NeighbourSlot(x, y, z)).*bits;
      return words == nullptr ? kNone.data() : words;
    };
    std::copy_n(at(0), kBlockSide, lattice[i].begin());
    lattice[i][kBlockSide] = *at(1);
  }
  return lattice;
}

// Whether any block that the cells reach has voxels behind the surface.
bool ReachBehind(const NeighbourWalk& walk) {
  for (int i = 0; i < 8; ++i) {
    if (walk.At(NeighbourSlot(i & 1, i >> 1 & 1, i >> 2)).behind != nullptr) return true;
  }
  return false;
}

// From the lowest set bit to the highest one.
CellBox::Range RangeOf(uint64_t bits) {
  return {std::countr_zero(bits), static_cast<int>(std::bit_width(bits))};
}

}  // namespace

CellBox BoxAround(const CellBits& cells) {
  uint64_t layer = 0, y = 0, z = 0;
  for (size_t i = 0; i < cells.size(); ++i) {
    layer |= cells[i];
    z |= uint64_t{cells[i] != 0} << i;
  }
  for (size_t i = 0; i < kBlockSide; ++i) y |= uint64_t{(layer >> (8 * i) & 0xFF) != 0} << i;
  uint64_t x = layer | layer >> 32;
  x |= x >> 16;
  x |= x >> 8;
  return {RangeOf(x & 0xFF), RangeOf(y), RangeOf(z)};
}

bool FindSurfaceCells(const NeighbourWalk& walk, CellBits* cells) {
  if (walk.At(NeighbourSlot(0, 0, 0)).observed == nullptr || !ReachBehind(walk)) return false;
  MarkSurfaceCells(ReadBits(walk, &BlockView::observed), ReadBits(walk, &BlockView::behind),
                   *cells);
  uint64_t any = 0;
  for (const uint64_t layer : *cells) any |= layer;
  return any != 0;
}

}  // namespace vismap
