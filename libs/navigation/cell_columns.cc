#include "navigation/cell_columns.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/format.h"
#include "base/parallel.h"
#include "freespace/shortest_text.h"

namespace vismap {
namespace {

/// The 8 x 8 bits of a word with rows and columns exchanged: bit x + 8 y goes to bit y + 8 x.
uint64_t Transposed(uint64_t bits) {
  uint64_t swap = (bits ^ (bits >> 7)) & 0x00aa00aa00aa00aaull;
  bits ^= swap ^ (swap << 7);
  swap = (bits ^ (bits >> 14)) & 0x0000cccc0000ccccull;
  bits ^= swap ^ (swap << 14);
  swap = (bits ^ (bits >> 28)) & 0x00000000f0f0f0f0ull;
  return bits ^ swap ^ (swap << 28);
}

/// The bits of a byte for the cells from <= i < to, where the byte has the cells 0 to 7.
uint8_t RangeMask(int32_t from, int32_t to) {
  const int first = std::clamp(from, 0, 8), end = std::clamp(to, first, 8);
  return static_cast<uint8_t>((0xff << first) & (0xff >> (8 - end)));
}

struct BlockRange {
  BlockIndex first, last;
};

std::optional<BlockRange> RangeOf(const OccupancyMap& map) {
  std::optional<BlockRange> range;
  map.blocks().ForEach([&](BlockIndex index, const BlockOccupancy&) {
    if (!range) range = {index, index};
    BlockIndex &a = range->first, &b = range->last;
    a = {std::min(a.x, index.x), std::min(a.y, index.y), std::min(a.z, index.z)};
    b = {std::max(b.x, index.x), std::max(b.y, index.y), std::max(b.z, index.z)};
  });
  return range;
}

}  // namespace

Result<CellColumns> CellColumns::Make(const OccupancyMap& map, size_t max_bytes) {
  CellColumns columns;
  const std::optional<BlockRange> range = RangeOf(map);
  if (!range) return columns;
  const auto count = [](int32_t first, int32_t last) { return double{1} + last - first; };
  const double x = count(range->first.x, range->last.x), y = count(range->first.y, range->last.y);
  const double z = count(range->first.z, range->last.z);
  if (const double bytes = 2 * 64 * x * y * z; !(bytes <= static_cast<double>(max_bytes))) {
    const double side = map.cell_size() * kBlockSide;
    return Fail("ground grid: the map of " + ShortestText(x * side) + " m x " +
                ShortestText(y * side) + " m x " + ShortestText(z * side) + " m would take " +
                FormatBytes(bytes) + "; expected at most " + FormatBytes(max_bytes) +
                "; use larger voxels");
  }
  columns.first_ = range->first;
  columns.blocks_x_ = static_cast<int32_t>(x);
  columns.blocks_y_ = static_cast<int32_t>(y);
  columns.blocks_z_ = static_cast<int32_t>(z);
  const BlockIndex& a = range->first;
  const BlockIndex& b = range->last;
  columns.box_ = {{8 * a.x, 8 * a.y, 8 * a.z}, {8 * b.x + 8, 8 * b.y + 8, 8 * b.z + 8}};
  const auto bytes = static_cast<size_t>(64 * x * y * z);
  columns.occupied_.resize(bytes);
  columns.free_.resize(bytes);
  const std::vector<BlockIndex> blocks = map.SortedIndices();
  ParallelFor(blocks.size(), 64, [&](size_t i) { columns.Add(blocks[i], map.At(blocks[i])); });
  return columns;
}

bool CellColumns::Inside(int32_t x, int32_t y) const {
  return x >= box_.min.x && x < box_.max.x && y >= box_.min.y && y < box_.max.y;
}

void CellColumns::Add(BlockIndex index, const BlockOccupancy& block) {
  const OccupancyPlanes planes = block.Planes();
  for (const bool occupied : {false, true}) {
    const VoxelBits& bits = occupied ? planes.occupied : planes.free;
    Bytes& out = occupied ? occupied_ : free_;
    for (int y = 0; y < kBlockSide; ++y) {
      uint64_t rows = 0;  // the row y of the eight layers
      for (size_t z = 0; z < bits.size(); ++z) rows |= ((bits[z] >> (8 * y)) & 0xff) << (8 * z);
      const uint64_t columns = Transposed(rows);
      for (int x = 0; x < kBlockSide; ++x) {
        const size_t at = At(8 * index.x + x, 8 * index.y + y);
        out[at + static_cast<size_t>(index.z - first_.z)] =
            static_cast<uint8_t>(columns >> (8 * x));
      }
    }
  }
}

bool CellColumns::AnyOccupied(int32_t x, int32_t y, int32_t from, int32_t to) const {
  if (!Inside(x, y)) return false;
  const uint8_t* column = Column(occupied_, x, y);
  const int32_t first = std::max(from, box_.min.z) - box_.min.z;
  const int32_t end = std::min(to, box_.max.z) - box_.min.z;
  for (int32_t byte = first / 8; 8 * byte < end; ++byte) {
    if ((column[byte] & RangeMask(first - 8 * byte, end - 8 * byte)) != 0) return true;
  }
  return false;
}

bool CellColumns::AnyFree(int32_t x, int32_t y, int32_t from, int32_t to) const {
  if (!Inside(x, y)) return false;
  const uint8_t* column = Column(free_, x, y);
  const int32_t first = std::max(from, box_.min.z) - box_.min.z;
  const int32_t end = std::min(to, box_.max.z) - box_.min.z;
  for (int32_t byte = first / 8; 8 * byte < end; ++byte) {
    if ((column[byte] & RangeMask(first - 8 * byte, end - 8 * byte)) != 0) return true;
  }
  return false;
}

bool CellColumns::AllFree(int32_t x, int32_t y, int32_t from, int32_t to) const {
  if (from >= to) return true;
  if (!Inside(x, y) || from < box_.min.z || to > box_.max.z) return false;
  const uint8_t* column = Column(free_, x, y);
  const int32_t first = from - box_.min.z, end = to - box_.min.z;
  for (int32_t byte = first / 8; 8 * byte < end; ++byte) {
    const uint8_t mask = RangeMask(first - 8 * byte, end - 8 * byte);
    if ((column[byte] & mask) != mask) return false;
  }
  return true;
}

uint64_t CellColumns::Bits64(const Bytes& bits, int32_t x, int32_t y, int32_t z) const {
  if (!Inside(x, y)) return 0;
  const uint8_t* column = Column(bits, x, y);
  const int32_t first = z - box_.min.z;
  if (const int32_t byte = first >> 3; byte >= 0 && byte + 9 <= blocks_z_) {
    static_assert(std::endian::native == std::endian::little);
    uint64_t window;
    std::memcpy(&window, column + byte, sizeof(window));
    const int right = first & 7;
    if (right > 0) window = window >> right | uint64_t{column[byte + 8]} << (64 - right);
    return window;
  }
  uint64_t window = 0;
  for (int32_t byte = first >> 3; byte <= (first + 63) >> 3; ++byte) {
    if (byte < 0 || byte >= blocks_z_) continue;
    const int32_t left = 8 * byte - first;
    window |= left >= 0 ? uint64_t{column[byte]} << left : uint64_t{column[byte]} >> -left;
  }
  return window;
}

CellColumns::Window CellColumns::At(int32_t x, int32_t y, int32_t z) const {
  return {Bits64(occupied_, x, y, z), Bits64(free_, x, y, z)};
}

std::optional<int32_t> CellColumns::HighestSupport(int32_t x, int32_t y, int32_t from,
                                                   int32_t to) const {
  constexpr int32_t kStep = 64 - kUnsureCells - 1;  // cells that one window decides
  const int32_t lowest = std::max(from, box_.min.z + 1);
  for (int32_t end = std::min(to, box_.max.z); end > lowest; end -= kStep) {
    const int32_t first = end - kStep;  // bit 1 of the window
    const Window window = At(x, y, first - 1);
    uint64_t open = window.free;  // cells with a free one soon above them
    for (int i = 0; i < kUnsureCells; ++i) open |= (open >> 1) & ~window.occupied;
    uint64_t supports = (window.occupied << 1) & ~window.occupied & open;
    supports &= ~uint64_t{0} >> (64 - kStep - 1);
    if (first < lowest) supports &= ~uint64_t{0} << (lowest - first + 1);
    if (supports != 0) return first - 1 + 63 - std::countl_zero(supports);
  }
  return std::nullopt;
}

}  // namespace vismap
