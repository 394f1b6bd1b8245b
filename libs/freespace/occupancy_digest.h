#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "freespace/occupancy.h"

namespace vismap {

/// Checksum of what is known of one block, and of its place; 0 = nothing is.
uint64_t ChecksumOf(BlockIndex index, const BlockOccupancy& occupancy);

/// Digest of the known blocks of a map, kept up to date block by block: equal for equal content,
/// whatever way it came about.
class OccupancyDigest {
 public:
  /// A block with one checksum now has another.
  void Replace(uint64_t before, uint64_t now);
  /// Blocks of which anything is known.
  size_t blocks() const { return blocks_; }
  /// 32 hexadecimal digits, of cells of this size [m].
  std::string Hex(double cell_size) const;

 private:
  void Toggle(uint64_t checksum, bool add);

  size_t blocks_ = 0;
  std::array<uint64_t, 2> sums_{};  // over all blocks, so that order cannot matter
};

}  // namespace vismap
