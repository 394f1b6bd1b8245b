#include "meshing/crossed_edges.h"

namespace vismap {

void CrossedEdges::ReadCorners(const NeighbourWalk& walk, CellBox::Range layers) {
  layers_ = layers;
  for (int z = layers.from; z <= layers.to; ++z) {
    const auto word = [&](int x, int y) -> uint64_t {
      const uint64_t* words = walk.At(NeighbourSlot(x, y, z / kBlockSide)).behind;
      return words == nullptr ? 0 : words[z % kBlockSide];
    };
    uint16_t* rows = &behind_[static_cast<size_t>(kBitRows * z)];
    SpreadRows(word(0, 0), word(1, 0), rows);
    rows[kBlockSide] = static_cast<uint16_t>((word(0, 1) & 0xFF) | (word(1, 1) & 1) << kBlockSide);
  }
}

void CrossedEdges::List(const CellBits& cells) {
  for (size_t z = 0; z < kBlockSide; ++z)
    SpreadRows(cells[z], 0, &cells_[kFirstCells + kBitRows * z]);
  const auto from = static_cast<size_t>(kBitRows * layers_.from);
  uint16_t* crossed = crossed_.data() + from;
  CrossEdges(&behind_[from], &cells_[kFirstCells + from],
             kBitRows * (layers_.to - layers_.from + 1),
             {crossed, crossed + kAxisSlots / kSlotStride, crossed + 2 * kAxisSlots / kSlotStride});
  count_ = 0;
  for (int axis = 0; axis < 3; ++axis) {
    first_[static_cast<size_t>(axis)] = count_;
    for (int z = layers_.from; z <= layers_.to; ++z) {
      for (int y = 0; y < kSlotSide; y += kRowsPerWord)
        AddSlots(static_cast<size_t>(EdgeSlot({0, y, z, axis})));
    }
  }
  first_.back() = count_;
}

inline void CrossedEdges::AddSlots(size_t first) {
  for (uint64_t bits = WordOf(&crossed_[first / kSlotStride]); bits != 0; bits &= bits - 1) {
    const size_t slot = first + static_cast<size_t>(std::countr_zero(bits));
    number_of_slot_[slot] = static_cast<uint16_t>(count_);
    slots_[count_++] = static_cast<uint16_t>(slot);
  }
}

}  // namespace vismap
