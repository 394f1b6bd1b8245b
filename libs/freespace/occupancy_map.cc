#include "freespace/occupancy_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/parallel.h"

namespace vismap {
namespace {

const BlockOccupancy kUnknownBlock;

/// The lowest set bit, and the highest one plus 1.
std::pair<int, int> BitRange(uint64_t bits) {
  return {std::countr_zero(bits), 64 - std::countl_zero(bits)};
}

/// The box of the known cells of a block, in coordinates 0..8 of the block.
OccupancyBox KnownInBlock(const BlockOccupancy& occupancy) {
  if (occupancy.is_uniform()) return {{0, 0, 0}, {8, 8, 8}};
  uint64_t layers = 0;
  uint64_t slab = 0;
  for (size_t z = 0; z < 8; ++z) {
    const uint64_t known = occupancy.mixed()->free[z] | occupancy.mixed()->occupied[z];
    if (known != 0) layers |= uint64_t{1} << z;
    slab |= known;
  }
  uint64_t rows = 0;
  uint64_t columns = 0;
  for (int y = 0; y < 8; ++y) {
    const uint64_t row = (slab >> (8 * y)) & 0xff;
    if (row != 0) rows |= uint64_t{1} << y;
    columns |= row;
  }
  const auto [x0, x1] = BitRange(columns);
  const auto [y0, y1] = BitRange(rows);
  const auto [z0, z1] = BitRange(layers);
  return {{x0, y0, z0}, {x1, y1, z1}};
}

std::vector<BlockIndex> SortedUnique(std::span<const BlockIndex> indices) {
  std::vector<BlockIndex> sorted(indices.begin(), indices.end());
  if (!std::is_sorted(sorted.begin(), sorted.end())) std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  return sorted;
}

}  // namespace

const BlockOccupancy& OccupancyMap::At(BlockIndex index) const {
  const BlockOccupancy* found = blocks_.Find(index);
  return found == nullptr ? kUnknownBlock : *found;
}

CellState OccupancyMap::At(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d cell = (p_W / cell_size_).array().floor();
  if (!(cell.cwiseAbs().maxCoeff() < 1e9)) return CellState::kUnknown;
  return At(VoxelIndex{static_cast<int32_t>(cell.x()), static_cast<int32_t>(cell.y()),
                       static_cast<int32_t>(cell.z())});
}

bool OccupancyMap::Set(BlockIndex index, const BlockOccupancy& occupancy) {
  const BlockOccupancy& before = At(index);
  if (before == occupancy) return false;
  digest_.Replace(ChecksumOf(index, before), ChecksumOf(index, occupancy));
  mixed_ -= !before.is_uniform();
  mixed_ += !occupancy.is_uniform();
  if (occupancy.is(CellState::kUnknown)) {
    blocks_.Erase(index);
  } else {
    blocks_.FindOrCreate(index) = occupancy;
  }
  return true;
}

OccupancyDelta OccupancyMap::Update(const SemanticMap& map, std::span<const BlockIndex> changed,
                                    const OccupancyOptions& options) {
  Require(map.voxels.voxel_size() == cell_size_, "occupancy and map have one voxel size");
  OccupancyDelta delta = ClassifyBlocks(map, changed, options);
  std::erase_if(delta.blocks,
                [this](const auto& block) { return !Set(block.first, block.second); });
  return delta;
}

Result<void> OccupancyMap::Apply(const OccupancyDelta& delta) {
  if (delta.complete) {
    *this = OccupancyMap(delta.voxel_size);
  } else if (delta.voxel_size != cell_size_) {
    return Fail("occupancy delta: expected voxels of " + std::to_string(cell_size_) +
                " m as in the map so far, found " + std::to_string(delta.voxel_size) + " m");
  }
  for (const auto& [index, occupancy] : delta.blocks) Set(index, occupancy);
  return {};
}

void Extend(const OccupancyBox& more, std::optional<OccupancyBox>* box) {
  if (!*box) *box = more;
  OccupancyBox& whole = **box;
  whole.min = {std::min(whole.min.x, more.min.x), std::min(whole.min.y, more.min.y),
               std::min(whole.min.z, more.min.z)};
  whole.max = {std::max(whole.max.x, more.max.x), std::max(whole.max.y, more.max.y),
               std::max(whole.max.z, more.max.z)};
}

OccupancyBox KnownCellsOf(BlockIndex index, const BlockOccupancy& occupancy) {
  const OccupancyBox local = KnownInBlock(occupancy);
  const VoxelIndex first{kBlockSide * index.x, kBlockSide * index.y, kBlockSide * index.z};
  return {{first.x + local.min.x, first.y + local.min.y, first.z + local.min.z},
          {first.x + local.max.x, first.y + local.max.y, first.z + local.max.z}};
}

std::optional<OccupancyBox> OccupancyMap::KnownCells() const {
  std::optional<OccupancyBox> box;
  blocks_.ForEach([&](BlockIndex index, const BlockOccupancy& occupancy) {
    Extend(KnownCellsOf(index, occupancy), &box);
  });
  return box;
}

OccupancyDelta ClassifyBlocks(const SemanticMap& map, std::span<const BlockIndex> blocks,
                              const OccupancyOptions& options) {
  OccupancyDelta delta{map.voxels.voxel_size(), false, {}};
  for (const BlockIndex& index : SortedUnique(blocks))
    delta.blocks.emplace_back(index, kUnknownBlock);
  ParallelFor(delta.blocks.size(), 64, [&](size_t i) {
    auto& [index, occupancy] = delta.blocks[i];
    if (const Block* block = map.voxels.Find(index))
      occupancy = ClassifyBlock(*block, map.voxels.options(), options);
  });
  return delta;
}

OccupancyMap ClassifyMap(const SemanticMap& map, const OccupancyOptions& options) {
  OccupancyMap occupancy(map.voxels.voxel_size());
  occupancy.Update(map, map.voxels.SortedIndices(), options);
  return occupancy;
}

CellCounts CountCells(const OccupancyMap& map) {
  CellCounts counts;
  map.blocks().ForEach([&](BlockIndex, const BlockOccupancy& block) {
    const OccupancyPlanes planes = block.Planes();
    for (const uint64_t word : planes.free) counts.free += std::popcount(word);
    for (const uint64_t word : planes.occupied) counts.occupied += std::popcount(word);
  });
  return counts;
}

}  // namespace vismap
