#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Cells above a surface that may be unknown, since they are too near to it to be surely free.
inline constexpr int kUnsureCells = 3;

/// The cells of an OccupancyMap by vertical columns (along z of W), as bits, within the box of all
/// blocks that are known. Coordinates are cells of the map.
class CellColumns {
 public:
  /// Fails when the columns would take more than `max_bytes`; the Error names the size of the map.
  static Result<CellColumns> Make(const OccupancyMap& map, size_t max_bytes = size_t{1} << 30);

  bool empty() const { return blocks_x_ == 0; }
  /// All cells with min <= cell < max may be known.
  const OccupancyBox& box() const { return box_; }

  /// Whether any cell of the column with from <= z < to is occupied.
  bool AnyOccupied(int32_t x, int32_t y, int32_t from, int32_t to) const;
  /// Whether all of these cells are free; true when there are none.
  bool AllFree(int32_t x, int32_t y, int32_t from, int32_t to) const;
  /// Whether any of these cells is free.
  bool AnyFree(int32_t x, int32_t y, int32_t from, int32_t to) const;
  /// 64 cells of a column from z on, as bits from the lowest; cells outside of the box are neither.
  struct Window {
    uint64_t occupied = 0, free = 0;
  };
  Window At(int32_t x, int32_t y, int32_t z) const;

  /// The highest z with from <= z < to on which something can stand: the cell under it, z - 1, is
  /// occupied, and one of the cells z to z + kUnsureCells is free, with no occupied one up to it.
  /// nullopt when there is none.
  std::optional<int32_t> HighestSupport(int32_t x, int32_t y, int32_t from, int32_t to) const;

 private:
  using Bytes = std::vector<uint8_t>;  // a byte holds eight cells of a column

  /// Where the bytes of a column begin.
  size_t At(int32_t x, int32_t y) const {
    const auto row = static_cast<size_t>(y - box_.min.y) * static_cast<size_t>(8 * blocks_x_);
    return (row + static_cast<size_t>(x - box_.min.x)) * static_cast<size_t>(blocks_z_);
  }
  const uint8_t* Column(const Bytes& bits, int32_t x, int32_t y) const {
    return bits.data() + At(x, y);
  }
  uint64_t Bits64(const Bytes& bits, int32_t x, int32_t y, int32_t z) const;
  bool Inside(int32_t x, int32_t y) const;
  void Add(BlockIndex index, const BlockOccupancy& block);

  OccupancyBox box_{};
  BlockIndex first_{};  // the first block of the box
  int32_t blocks_x_ = 0, blocks_y_ = 0, blocks_z_ = 0;
  Bytes occupied_, free_;
};

}  // namespace vismap
