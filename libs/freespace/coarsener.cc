#include "freespace/coarsener.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"
#include "base/require.h"

namespace vismap {
namespace {

constexpr int kParts = 3;  // cells that a block touches along an axis, at most
constexpr uint64_t kAllParts = (uint64_t{1} << (kParts * kParts * kParts)) - 1;
constexpr int kFreeShift = 32;

/// The bits of the parts that a block has.
uint64_t PartsIn(const Overlaps& xs, const Overlaps& ys, const Overlaps& zs) {
  uint64_t parts = 0;
  for (size_t z = 0; z < zs.size; ++z) {
    for (size_t y = 0; y < ys.size; ++y)
      parts |= ((uint64_t{1} << xs.size) - 1) << (kParts * (y + kParts * z));
  }
  return parts;
}

/// The bits of the parts in which any of these voxels lies.
uint64_t PartsWith(const VoxelBits& voxels, const Overlaps& xs, const Overlaps& ys,
                   const Overlaps& zs) {
  uint64_t parts = 0;
  int first = 0;  // bit of the first part of a row
  for (const CellOverlap& z : zs) {
    uint64_t slab = 0;
    for (int layer = z.begin; layer < z.begin + z.count; ++layer)
      slab |= voxels[static_cast<size_t>(layer)];
    for (const CellOverlap& y : ys) {
      uint64_t row = slab & y.rows;
      row |= row >> 32;
      row |= row >> 16;
      row |= row >> 8;
      int bit = first;
      for (const CellOverlap& x : xs) parts |= uint64_t{(row & x.mask) != 0} << bit++;
      first += kParts;
    }
    first += kParts * (kParts - static_cast<int>(ys.size));
  }
  return parts;
}

/// The parts of one layer as cells of a block, before they are moved to their place.
uint64_t CellsOfLayer(uint64_t parts) {
  return (parts & 7) | (parts & 070) << (kBlockSide - kParts) |
         (parts & 0700) << 2 * (kBlockSide - kParts);
}

void AddParts(uint64_t parts, const Overlaps& xs, const Overlaps& ys, const Overlaps& zs,
              VoxelBits* cells) {
  const int place = xs.items[0].cell + kBlockSide * ys.items[0].cell;
  for (auto z = static_cast<size_t>(zs.items[0].cell); parts != 0; ++z) {
    (*cells)[z] |= CellsOfLayer(parts) << place;
    parts >>= kParts * kParts;
  }
}

}  // namespace

Coarsener::Coarsener(double voxel_size, const CoarsenOptions& options)
    : voxel_size_(voxel_size), options_(options), coarse_(voxel_size * options.factor) {
  constexpr int kLeast = 4, kMost = 16;  // fewer touch more cells; more would take much memory
  if (options.free_fraction < 1 || options.factor < kLeast || options.factor > kMost) return;
  for (int position = 0; position < options.factor; ++position)
    overlaps_.push_back(OverlapsAt(position, options.factor));
}

Coarsener::Parts Coarsener::PartsOf(BlockIndex index, const BlockOccupancy& block) const {
  if (block.is(CellState::kUnknown)) return 0;
  const BlockIndex coarse = CoarseIndex(index, options_.factor);
  const auto at = [&](int32_t fine, int32_t first) -> const Overlaps& {
    return overlaps_[static_cast<size_t>(fine - first * options_.factor)];
  };
  const Overlaps &xs = at(index.x, coarse.x), &ys = at(index.y, coarse.y),
                 &zs = at(index.z, coarse.z);
  const uint64_t all = PartsIn(xs, ys, zs);
  if (block.is(CellState::kFree)) return all << kFreeShift;
  if (block.is(CellState::kOccupied)) return all;
  VoxelBits not_free;
  for (size_t z = 0; z < not_free.size(); ++z) not_free[z] = ~block.mixed()->free[z];
  return PartsWith(block.mixed()->occupied, xs, ys, zs) | (all & ~PartsWith(not_free, xs, ys, zs))
                                                              << kFreeShift;
}

/// Takes over what the changed blocks say now. Returns the coarse blocks that this may change,
/// ascending.
std::vector<BlockIndex> Coarsener::TakeParts(const OccupancyMap& fine,
                                             std::span<const BlockIndex> changed) {
  std::vector<Parts> now(changed.size());
  ParallelForGroups(changed.size(), 512, [&](size_t from, size_t to) {
    BlockTable<BlockOccupancy>::Reader reader(fine.blocks());
    for (size_t i = from; i < to; ++i) {
      const BlockOccupancy* block = reader.Find(changed[i]);
      now[i] = block == nullptr ? 0 : PartsOf(changed[i], *block);
    }
  });
  const int n = options_.factor;
  std::vector<BlockIndex> touched;
  for (size_t i = 0; i < changed.size(); ++i) {
    const BlockIndex fine_index = changed[i], coarse = CoarseIndex(fine_index, n);
    std::vector<Parts>* parts = parts_.Find(coarse);
    if (parts == nullptr) {
      if (now[i] == 0) continue;
      parts = &parts_.FindOrCreate(coarse);
      parts->resize(static_cast<size_t>(n * n * n));
    }
    const int x = fine_index.x - n * coarse.x, y = fine_index.y - n * coarse.y,
              z = fine_index.z - n * coarse.z;
    Parts& kept = (*parts)[static_cast<size_t>(x + n * (y + n * z))];
    if (kept == now[i]) continue;
    kept = now[i];
    touched.push_back(fine_index);
  }
  return CoarseBlocksOf(touched, n);
}

BlockOccupancy Coarsener::Assemble(const std::vector<Parts>& parts) const {
  VoxelBits occupied{}, not_free{};
  const Parts* at = parts.data();
  for (const Overlaps& zs : overlaps_) {
    for (const Overlaps& ys : overlaps_) {
      for (const Overlaps& xs : overlaps_) {
        const Parts said = *at++;
        AddParts(PartsIn(xs, ys, zs) & ~(said >> kFreeShift), xs, ys, zs, &not_free);
        AddParts(said & kAllParts, xs, ys, zs, &occupied);
      }
    }
  }
  OccupancyPlanes planes;
  planes.occupied = occupied;
  for (size_t z = 0; z < planes.free.size(); ++z) planes.free[z] = ~not_free[z];
  return BlockOccupancy(planes);
}

OccupancyDelta Coarsener::Update(const OccupancyMap& fine, std::span<const BlockIndex> changed) {
  Require(fine.cell_size() == voxel_size_, "a Coarsener has one size of voxels");
  const std::vector<BlockIndex> indices =
      remembers_parts() ? TakeParts(fine, changed) : CoarseBlocksOf(changed, options_.factor);
  std::vector<BlockOccupancy> now(indices.size());
  ParallelFor(indices.size(), 16, [&](size_t i) {
    const std::vector<Parts>* parts = std::as_const(parts_).Find(indices[i]);
    if (remembers_parts()) {
      now[i] = parts == nullptr ? BlockOccupancy() : Assemble(*parts);
    } else {
      now[i] = CoarsenBlock(fine, indices[i], options_);
    }
  });
  OccupancyDelta delta{coarse_.cell_size(), false, {}};
  for (size_t i = 0; i < indices.size(); ++i) {
    if (coarse_.Set(indices[i], now[i])) delta.blocks.emplace_back(indices[i], now[i]);
  }
  return delta;
}

}  // namespace vismap
