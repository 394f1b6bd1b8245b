#include "freespace/occupancy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "base/require.h"
#include "map/block.h"

namespace vismap {
namespace {

constexpr size_t kWords = kBlockVoxels / 64;

bool All(const std::array<uint64_t, kWords>& plane, uint64_t word) {
  return std::all_of(plane.begin(), plane.end(), [&](uint64_t w) { return w == word; });
}

/// Packs eight bytes of 0 or 1 to eight bits; the first byte becomes the lowest bit.
uint64_t PackEight(const uint8_t* bytes) {
  static_assert(std::endian::native == std::endian::little);
  uint64_t eight = 0;
  std::memcpy(&eight, bytes, sizeof(eight));
  return (eight * 0x0102040810204080ull) >> 56;
}

void Pack(const std::array<uint8_t, kBlockVoxels>& flags, std::array<uint64_t, kWords>* plane) {
  for (size_t word = 0; word < kWords; ++word) {
    uint64_t bits = 0;
    for (size_t byte = 0; byte < 8; ++byte) {
      bits |= PackEight(&flags[64 * word + 8 * byte]) << (8 * byte);
    }
    (*plane)[word] = bits;
  }
}

/// A distance [voxels] in the steps of SurfaceVoxels::distance.
int16_t DistanceSteps(double voxels, const VoxelGridOptions& grid, double (*round)(double)) {
  const double steps = round(voxels / grid.truncation_voxels * kTruncationSteps);
  using Limits = std::numeric_limits<int16_t>;
  return static_cast<int16_t>(std::clamp<double>(steps, Limits::min(), Limits::max()));
}

OccupancyPlanes ClassifySurface(const SurfaceVoxels& voxels, const VoxelGridOptions& grid,
                                const OccupancyOptions& options) {
  const int occupied_max = DistanceSteps(options.occupied_max_voxels, grid, std::floor);
  const int free_min = DistanceSteps(options.free_min_voxels, grid, std::ceil);
  const int min_observations = std::clamp(options.min_observations, 1, 255);
  std::array<uint8_t, kBlockVoxels> free{};
  std::array<uint8_t, kBlockVoxels> occupied{};
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    const bool seen = (voxels.observations[i] >= min_observations) & (voxels.weight[i] > 0);
    const bool near = voxels.distance[i] <= occupied_max;
    const bool far = voxels.distance[i] >= free_min;
    occupied[i] = seen & near;
    free[i] = seen & far & !near;
  }
  OccupancyPlanes planes;
  Pack(free, &planes.free);
  Pack(occupied, &planes.occupied);
  return planes;
}

}  // namespace

BlockOccupancy::BlockOccupancy(const OccupancyPlanes& planes) : uniform_(CellState::kUnknown) {
  for (size_t i = 0; i < kWords; ++i) {
    Require((planes.free[i] & planes.occupied[i]) == 0, "a voxel is free or occupied, not both");
  }
  if (All(planes.free, ~uint64_t{0})) {
    uniform_ = CellState::kFree;
  } else if (All(planes.occupied, ~uint64_t{0})) {
    uniform_ = CellState::kOccupied;
  } else if (!All(planes.free, 0) || !All(planes.occupied, 0)) {
    planes_ = std::make_shared<const OccupancyPlanes>(planes);
  }
}

CellState BlockOccupancy::At(int offset) const {
  if (is_uniform()) return uniform_;
  const size_t word = static_cast<size_t>(offset) / 64;
  if ((planes_->free[word] >> (offset % 64)) & 1) return CellState::kFree;
  if ((planes_->occupied[word] >> (offset % 64)) & 1) return CellState::kOccupied;
  return CellState::kUnknown;
}

OccupancyPlanes BlockOccupancy::Planes() const {
  if (planes_) return *planes_;
  OccupancyPlanes planes;
  if (uniform_ == CellState::kFree) planes.free.fill(~uint64_t{0});
  if (uniform_ == CellState::kOccupied) planes.occupied.fill(~uint64_t{0});
  return planes;
}

namespace {

BlockOccupancy ClassifyDistances(const Block& block, const VoxelGridOptions& grid,
                                 const OccupancyOptions& options) {
  if (block.surface.packed()) {
    static thread_local SurfaceVoxels unpacked;  // made once, since most blocks of a map are packed
    block.surface.CopyTo(&unpacked);
    return BlockOccupancy(ClassifySurface(unpacked, grid, options));
  }
  if (const SurfaceVoxels* voxels = block.surface.get())
    return BlockOccupancy(ClassifySurface(*voxels, grid, options));
  if (block.all_free) return BlockOccupancy(CellState::kFree);
  if (!block.free) return BlockOccupancy(CellState::kUnknown);
  OccupancyPlanes planes;
  planes.free = options.min_observations <= 1 ? block.free->once : block.free->twice;
  return BlockOccupancy(planes);
}

}  // namespace

BlockOccupancy ClassifyBlock(const Block& block, const VoxelGridOptions& grid,
                             const OccupancyOptions& options) {
  BlockOccupancy occupancy = ClassifyDistances(block, grid, options);
  if (!block.thin || options.thin_hits <= 0) return occupancy;
  OccupancyPlanes planes = occupancy.Planes();
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    if (block.thin->hits[i] < options.thin_hits) continue;
    const uint64_t bit = uint64_t{1} << (i % 64);
    planes.occupied[i / 64] |= bit;
    planes.free[i / 64] &= ~bit;
  }
  return BlockOccupancy(planes);
}

}  // namespace vismap
