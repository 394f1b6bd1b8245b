#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "freespace/occupancy.h"

namespace vismap {

/// Checksum of the index and occupancy of a block; 0 = the block is unknown everywhere.
uint64_t ChecksumOf(BlockIndex index, const BlockOccupancy& occupancy);

/// Digest of all blocks that are not unknown, updated block by block. It depends on the content
/// only, not on the order of the updates.
class OccupancyDigest {
 public:
  /// Replaces the checksum of a block, see ChecksumOf.
  void Replace(uint64_t before, uint64_t now);
  /// Number of blocks that are not unknown everywhere.
  size_t blocks() const { return blocks_; }
  /// The digest for cells of this size [m]: 32 hexadecimal digits.
  std::string Hex(double cell_size) const;

 private:
  void Toggle(uint64_t checksum, bool add);

  size_t blocks_ = 0;
  std::array<uint64_t, 2> sums_{};  // over all blocks; sums do not depend on the order
};

}  // namespace vismap
