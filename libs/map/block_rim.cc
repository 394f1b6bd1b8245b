#include "map/block_rim.h"

#include <array>

namespace vismap {
namespace {

static_assert(kRimBelow == 1 && kRimAbove == 2, "the masks below are for these");

// Of the 64 voxels of a layer, those in the block at -1, 0 and 1 along an axis or in its rim.
constexpr std::array<uint64_t, 3> kSeenAlongX = {0x0303030303030303, ~uint64_t{0},
                                                 0x8080808080808080};
constexpr std::array<uint64_t, 3> kSeenAlongY = {0xFFFF, ~uint64_t{0}, uint64_t{0xFF} << 56};

}  // namespace

NeighbourBits AffectedBy(const VoxelBits& voxels) {
  uint64_t all = 0;
  for (const uint64_t layer : voxels) all |= layer;
  const std::array<uint64_t, 3> seen_along_z = {voxels[0] | voxels[1], all, voxels[7]};
  NeighbourBits affected = 0;
  size_t slot = 0;
  for (const uint64_t x : kSeenAlongX) {
    for (const uint64_t y : kSeenAlongY) {
      for (const uint64_t z : seen_along_z) affected |= NeighbourBits{(x & y & z) != 0} << slot++;
    }
  }
  return affected;
}

}  // namespace vismap
