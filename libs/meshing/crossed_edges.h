#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "meshing/lattice_edge.h"
#include "meshing/mesh_kernels.h"
#include "meshing/surface_cells.h"

namespace vismap {

/// Which edges of a block's cells the surface crosses, found for whole rows at a time: each of them
/// gets one vertex, and these are numbered by slot. So no cell asks whether another one came first.
class CrossedEdges {
 public:
  /// Reads which corners of some layers of cells are behind the surface, of the block that the walk
  /// is at.
  void ReadCorners(const NeighbourWalk& walk, CellBox::Range layers);
  void Clear() { count_ = 0; }
  /// Lists the crossed edges of some cells in the layers that were read.
  void List(const CellBits& cells);

  /// Those listed, ascending, as numbers of EdgeSlot.
  std::span<const uint16_t> slots() const { return std::span(slots_).first(count_); }
  /// Where a listed edge is in the list.
  uint16_t NumberOf(size_t slot) const { return number_of_slot_[slot]; }

  /// Which corners of a cell are behind the surface: bit x + 2 y + 4 z.
  size_t CubeOf(int x, int y, int z) const {
    const uint16_t* row = &behind_[static_cast<size_t>(y + kBitRows * z)];
    const auto pair = [x](uint16_t bits) { return static_cast<size_t>(bits >> x & 3); };
    return pair(row[0]) | pair(row[1]) << 2 | pair(row[kBitRows]) << 4 |
           pair(row[kBitRows + 1]) << 6;
  }

 private:
  // Those crossed among a word of rows, from one slot on.
  void AddSlots(size_t first);

  static constexpr size_t kMostEdges = 3 * kBlockSide * kSlotSide * kSlotSide;

  CellBox::Range layers_;
  std::array<uint16_t, kBitRows*(kSlotSide + 1)> behind_{};
  // With the layers around those of the block, and a row before all.
  std::array<uint16_t, 1 + kBitRows*(kSlotSide + 1)> cells_{};
  alignas(64) std::array<uint16_t, kEdgeSlots / kSlotStride> crossed_{};  // bit = slot
  std::array<uint16_t, kMostEdges> slots_;
  size_t count_ = 0;
  std::array<uint16_t, kEdgeSlots> number_of_slot_;  // of listed ones
};

}  // namespace vismap
