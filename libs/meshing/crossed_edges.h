#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
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
  void Clear() {
    count_ = 0;
    first_ = {};
  }
  /// Lists the crossed edges of some cells in the layers that were read.
  void List(const CellBits& cells);

  /// Those listed, ascending, as numbers of EdgeSlot.
  std::span<const uint16_t> slots() const { return std::span(slots_).first(count_); }
  /// Where those along an axis begin in the list; those along axis 3, which are none, at its end.
  size_t FirstAlong(size_t axis) const { return first_[axis]; }
  /// Where a listed edge is in the list.
  uint16_t NumberOf(size_t slot) const { return number_of_slot_[slot]; }

  /// Calls `visit(cell)` for each of the cells that edges were listed of, ascending by layers.
  /// Cells are numbered as their first edges: see EdgeSlot.
  template <typename Visit>
  void ForEachCell(const Visit& visit) const {
    for (int z = layers_.from; z < layers_.to; ++z) {
      for (int y = 0; y < kBlockSide; y += kRowsPerWord) {
        const auto first = static_cast<size_t>(EdgeSlot({0, y, z}));
        const uint64_t word = WordOf(&cells_[kFirstCells + first / kSlotStride]);
        for (uint64_t bits = word; bits != 0; bits &= bits - 1)
          visit(first + static_cast<size_t>(std::countr_zero(bits)));
      }
    }
  }
  /// Which corners of a cell are behind the surface: bit x + 2 y + 4 z.
  size_t CubeOf(size_t cell) const {
    const uint16_t* row = &behind_[cell / kSlotStride];
    const auto pair = [x = cell % kSlotStride](uint16_t bits) -> size_t { return bits >> x & 3; };
    return pair(row[0]) | pair(row[1]) << 2 | pair(row[kBitRows]) << 4 |
           pair(row[kBitRows + 1]) << 6;
  }

 private:
  static constexpr int kRowsPerWord = 4;
  static uint64_t WordOf(const uint16_t* rows) {
    uint64_t word;
    static_assert(sizeof(word) == kRowsPerWord * sizeof(*rows));
    std::memcpy(&word, rows, sizeof(word));
    return word;
  }
  // Those crossed among a word of rows, from one slot on.
  void AddSlots(size_t first);

  static constexpr size_t kFirstCells = kBitRows + 1;  // of the block
  static constexpr size_t kMostEdges = 3 * kBlockSide * kSlotSide * kSlotSide;

  CellBox::Range layers_;
  std::array<uint16_t, kBitRows*(kSlotSide + 1)> behind_{};
  // With the layers around those of the block, and a row before all.
  std::array<uint16_t, 1 + kBitRows*(kSlotSide + 1)> cells_{};
  alignas(64) std::array<uint16_t, kEdgeSlots / kSlotStride> crossed_{};  // bit = slot
  std::array<uint16_t, kMostEdges> slots_;
  size_t count_ = 0;
  std::array<size_t, 4> first_{};                    // by axis
  std::array<uint16_t, kEdgeSlots> number_of_slot_;  // of listed ones
};

}  // namespace vismap
