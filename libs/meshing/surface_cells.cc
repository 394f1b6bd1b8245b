#include "meshing/surface_cells.h"

#include <bit>

namespace vismap {
namespace {

constexpr uint64_t kFirstOfRows = 0x0101010101010101u;  // x = 0 of the rows y = 0..7
constexpr uint64_t kFirstRow = 0xFF;

// Bits of the voxels of a layer, z = 0..8, of a block and of those behind it along x and y.
struct Layer {
  uint64_t own = 0, x = 0, y = 0, xy = 0;
};

using Bits = const uint64_t* BlockView::*;

Layer ReadLayer(const NeighbourWalk& walk, Bits bits, int z) {
  const auto word = [&](int x, int y) -> uint64_t {
    const uint64_t* words = walk.At(NeighbourSlot(x, y, z / kBlockSide)).*bits;
    return words == nullptr ? 0 : words[z % kBlockSide];
  };
  return {word(0, 0), word(1, 0), word(0, 1), word(1, 1)};
}

// Of every voxel the one next to it along x.
uint64_t NextAlongX(uint64_t own, uint64_t behind) {
  return ((own >> 1) & ~(kFirstOfRows << 7)) | ((behind & kFirstOfRows) << 7);
}
uint64_t NextAlongY(uint64_t own, uint64_t behind) { return own >> 8 | (behind & kFirstRow) << 56; }

// Over the four corners of a cell in its layer.
uint64_t AllOfFour(const Layer& layer) {
  const uint64_t pairs = layer.own & NextAlongX(layer.own, layer.x);
  const uint64_t beyond = layer.y & NextAlongX(layer.y, layer.xy);
  return pairs & NextAlongY(pairs, beyond);
}
uint64_t AnyOfFour(const Layer& layer) {
  const uint64_t pairs = layer.own | NextAlongX(layer.own, layer.x);
  const uint64_t beyond = layer.y | NextAlongX(layer.y, layer.xy);
  return pairs | NextAlongY(pairs, beyond);
}

// Of the layers z and z + 1 together.
struct Corners {
  uint64_t observed = 0, any_behind = 0, all_behind = 0;
};

Corners ReadCorners(const NeighbourWalk& walk, int z) {
  const Layer behind = ReadLayer(walk, &BlockView::behind, z);
  return {AllOfFour(ReadLayer(walk, &BlockView::observed, z)), AnyOfFour(behind),
          AllOfFour(behind)};
}

// Whether there is anything behind the surface where the cells of a block reach.
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
  uint64_t any = 0;
  Corners below = ReadCorners(walk, 0);
  for (int z = 0; z < kBlockSide; ++z) {
    const Corners above = ReadCorners(walk, z + 1);
    const uint64_t found = below.observed & above.observed & (below.any_behind | above.any_behind) &
                           ~(below.all_behind & above.all_behind);
    (*cells)[static_cast<size_t>(z)] = found;
    any |= found;
    below = above;
  }
  return any != 0;
}

}  // namespace vismap
