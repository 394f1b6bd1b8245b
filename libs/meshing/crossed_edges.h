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

/// The edges of a block's cells that the surface crosses, found for whole rows at a time. Each gets
/// one vertex, numbered in the order of slots, so that cells share vertices without a look-up
/// table.
class CrossedEdges {
 public:
  /// Reads which corners of some layers of cells in the walk's block are behind the surface.
  void ReadCorners(const NeighbourWalk& walk, CellBox::Range layers);
  void Clear() {
    count_ = 0;
    first_ = {};
  }
  /// Lists the crossed edges of some cells, all in the layers that were read.
  void List(const CellBits& cells);

  /// The slots of the listed edges, ascending, see EdgeSlot.
  std::span<const uint16_t> slots() const { return std::span(slots_).first(count_); }
  /// Index of the first edge along an axis in the list; the size of the list for axis 3.
  size_t FirstAlong(size_t axis) const { return first_[axis]; }
  /// Index of a listed edge in the list.
  uint16_t NumberOf(size_t slot) const { return number_of_slot_[slot]; }

  /// Calls `visit(cell)` for each cell whose edges were listed, layer by layer. The number of a
  /// cell is the slot of its edge along x at its lowest corner.
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
  /// The corners of a cell that are behind the surface: bit x + 2 y + 4 z.
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
  // Lists the crossed edges in a word of rows that begins at slot `first`.
  void AddSlots(size_t first);

  static constexpr size_t kFirstCells = kBitRows + 1;  // row of the block's first cells in cells_
  static constexpr size_t kMostEdges = 3 * kBlockSide * kSlotSide * kSlotSide;

  CellBox::Range layers_;
  std::array<uint16_t, kBitRows*(kSlotSide + 1)> behind_{};
  // With a layer before those of the block, one behind them, and a row before all.
  std::array<uint16_t, 1 + kBitRows*(kSlotSide + 1)> cells_{};
  alignas(64) std::array<uint16_t, kEdgeSlots / kSlotStride> crossed_{};  // bit = slot
  std::array<uint16_t, kMostEdges> slots_;
  size_t count_ = 0;
  std::array<size_t, 4> first_{};                    // by axis
  std::array<uint16_t, kEdgeSlots> number_of_slot_;  // set for listed edges
};

}  // namespace vismap
