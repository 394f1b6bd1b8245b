#include "freespace/occupancy_digest.h"

#include <algorithm>
#include <bit>

#include "base/digest.h"

namespace vismap {
namespace {

// Maps every number to another one, so that a second sum is independent of the first.
uint64_t Scramble(uint64_t x) {
  x = (x ^ x >> 32) * 0xD6E8FEB86659FD93u;
  x = (x ^ x >> 32) * 0xD6E8FEB86659FD93u;
  return x ^ x >> 32;
}

}  // namespace

uint64_t ChecksumOf(BlockIndex index, const BlockOccupancy& occupancy) {
  if (occupancy.is(CellState::kUnknown)) return 0;
  struct {
    BlockIndex index;
    uint32_t state;
    OccupancyPlanes planes;
  } content{index, static_cast<uint32_t>(occupancy.uniform_state()), {}};
  static_assert(sizeof(content) == 12 + 4 + 128, "no padding: all bytes are hashed");
  size_t size = sizeof(content) - sizeof(OccupancyPlanes);
  if (const OccupancyPlanes* planes = occupancy.mixed()) {
    content.state = 3;
    content.planes = *planes;
    size = sizeof(content);
  }
  return std::max<uint64_t>(1, Checksum64({reinterpret_cast<const uint8_t*>(&content), size}));
}

void OccupancyDigest::Replace(uint64_t before, uint64_t now) {
  if (before != 0) Toggle(before, false);
  if (now != 0) Toggle(now, true);
}

void OccupancyDigest::Toggle(uint64_t checksum, bool add) {
  const uint64_t second = Scramble(checksum);
  sums_[0] += add ? checksum : 0 - checksum;
  sums_[1] += add ? second : 0 - second;
  blocks_ += add ? size_t{1} : ~size_t{0};
}

std::string OccupancyDigest::Hex(double cell_size) const {
  Digest digest;
  digest.Add(cell_size);
  digest.Add(static_cast<uint64_t>(blocks_));
  digest.Add(sums_[0]);
  digest.Add(sums_[1]);
  return digest.Hex();
}

}  // namespace vismap
