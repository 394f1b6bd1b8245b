#include "freespace/coarsen.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "freespace/cell_overlaps.h"

namespace vismap {
namespace {

constexpr uint64_t kEveryRow = 0x0101010101010101ull;

struct Counters {
  std::array<uint32_t, kBlockVoxels> free{};
  std::array<uint32_t, kBlockVoxels> occupied{};
};

size_t CellOffset(const CellOverlap& x, const CellOverlap& y, const CellOverlap& z) {
  return static_cast<size_t>(LinearIndex(x.cell, y.cell, z.cell));
}

void AddUniform(const Overlaps& xs, const Overlaps& ys, const Overlaps& zs,
                std::array<uint32_t, kBlockVoxels>* count) {
  for (const CellOverlap& z : zs) {
    for (const CellOverlap& y : ys) {
      for (const CellOverlap& x : xs) {
        (*count)[CellOffset(x, y, z)] += static_cast<uint32_t>(x.count * y.count * z.count);
      }
    }
  }
}

/// The number of bits set in each byte. The packages are built for processors that have no
/// instruction for this.
constexpr uint64_t BitsPerByte(uint64_t bits) {
  bits -= (bits >> 1) & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + ((bits >> 2) & 0x3333333333333333u);
  return (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}

constexpr uint32_t SumOfBytes(uint64_t bytes) {
  constexpr uint64_t kEveryOther = 0x00ff00ff00ff00ffu;
  const uint64_t pairs = (bytes & kEveryOther) + ((bytes >> 8) & kEveryOther);
  return static_cast<uint32_t>((pairs * 0x0001000100010001u) >> 48);
}

void AddPlane(const std::array<uint64_t, 8>& plane, const Overlaps& xs, const Overlaps& ys,
              const Overlaps& zs, std::array<uint32_t, kBlockVoxels>* count) {
  for (const CellOverlap& z : zs) {
    for (const CellOverlap& x : xs) {
      uint64_t in_rows = 0;  // voxels in each row of the layers, at most 64
      for (int layer = z.begin; layer < z.begin + z.count; ++layer) {
        in_rows += BitsPerByte(plane[static_cast<size_t>(layer)] & (x.mask * kEveryRow));
      }
      if (in_rows == 0) continue;
      for (const CellOverlap& y : ys) (*count)[CellOffset(x, y, z)] += SumOfBytes(in_rows & y.rows);
    }
  }
}

BlockOccupancy Decide(const Counters& counters, const CoarsenOptions& options) {
  const double voxels = std::pow(options.factor, 3);
  const auto enough = static_cast<uint32_t>(std::ceil(options.free_fraction * voxels - 1e-9));
  OccupancyPlanes planes;
  for (size_t i = 0; i < kBlockVoxels; ++i) {
    const bool occupied = counters.occupied[i] > 0;
    const bool free = !occupied && counters.free[i] >= enough;
    planes.occupied[i / 64] |= uint64_t{occupied} << (i % 64);
    planes.free[i / 64] |= uint64_t{free} << (i % 64);
  }
  return BlockOccupancy(planes);
}

/// Cells of a coarse block in which some voxel is occupied, and some is not free: bit x + 8 y of
/// word z.
struct AnyVoxel {
  VoxelBits occupied{}, not_free{};
};

/// Sets the cells in which any of the voxels of `plane` lies.
void AddAny(const VoxelBits& plane, const Overlaps& xs, const Overlaps& ys, const Overlaps& zs,
            VoxelBits* any) {
  for (const CellOverlap& z : zs) {
    uint64_t slab = 0;
    for (int layer = z.begin; layer < z.begin + z.count; ++layer)
      slab |= plane[static_cast<size_t>(layer)];
    if (slab == 0) continue;
    uint64_t cells = 0;
    for (const CellOverlap& y : ys) {
      uint64_t row = slab & y.rows;
      row |= row >> 32;
      row |= row >> 16;
      row |= row >> 8;
      for (const CellOverlap& x : xs)
        cells |= uint64_t{(row & x.mask) != 0} << (x.cell + kBlockSide * y.cell);
    }
    (*any)[static_cast<size_t>(z.cell)] |= cells;
  }
}

/// Adds a block for cells that are free only when all of their voxels are, which needs no counting.
void AddBlock(const BlockOccupancy& block, const Overlaps& xs, const Overlaps& ys,
              const Overlaps& zs, AnyVoxel* any) {
  if (block.is(CellState::kFree)) return;
  if (const OccupancyPlanes* planes = block.mixed()) {
    VoxelBits not_free;
    for (size_t z = 0; z < not_free.size(); ++z) not_free[z] = ~planes->free[z];
    AddAny(planes->occupied, xs, ys, zs, &any->occupied);
    AddAny(not_free, xs, ys, zs, &any->not_free);
    return;
  }
  const uint64_t cells = CellsOf(xs, ys);
  for (const CellOverlap& z : zs) {
    any->not_free[static_cast<size_t>(z.cell)] |= cells;
    if (block.is(CellState::kOccupied)) any->occupied[static_cast<size_t>(z.cell)] |= cells;
  }
}

BlockOccupancy Decide(const AnyVoxel& any) {
  OccupancyPlanes planes;
  planes.occupied = any.occupied;
  for (size_t z = 0; z < planes.free.size(); ++z) planes.free[z] = ~any.not_free[z];
  return BlockOccupancy(planes);
}

void CountBlock(const BlockOccupancy& block, const Overlaps& xs, const Overlaps& ys,
                const Overlaps& zs, Counters* counters) {
  if (block.is(CellState::kUnknown)) return;
  if (const OccupancyPlanes* planes = block.mixed()) {
    AddPlane(planes->free, xs, ys, zs, &counters->free);
    AddPlane(planes->occupied, xs, ys, zs, &counters->occupied);
  } else {
    const bool free = block.uniform_state() == CellState::kFree;
    AddUniform(xs, ys, zs, free ? &counters->free : &counters->occupied);
  }
}

/// Calls `visit(block, xs, ys, zs)` with the n^3 blocks of which a coarse block is made.
template <typename Visit>
void ForEachFineBlock(const OccupancyMap& fine, BlockIndex index, int n, const Visit& visit) {
  std::vector<Overlaps> overlaps;
  for (int position = 0; position < n; ++position) overlaps.push_back(OverlapsAt(position, n));
  BlockTable<BlockOccupancy>::Reader reader(fine.blocks());
  const BlockOccupancy unknown;
  for (int z = 0; z < n; ++z) {
    for (int y = 0; y < n; ++y) {
      for (int x = 0; x < n; ++x) {
        const BlockOccupancy* block =
            reader.Find(BlockIndex{index.x * n + x, index.y * n + y, index.z * n + z});
        visit(block == nullptr ? unknown : *block, overlaps[static_cast<size_t>(x)],
              overlaps[static_cast<size_t>(y)], overlaps[static_cast<size_t>(z)]);
      }
    }
  }
}

}  // namespace

BlockOccupancy CoarsenBlock(const OccupancyMap& fine, BlockIndex index,
                            const CoarsenOptions& options) {
  const int n = options.factor;
  Require(n >= 1 && n <= 64, "a cell has 1 to 64 voxels along its edge");
  if (options.free_fraction < 1) {
    Counters counters;
    ForEachFineBlock(fine, index, n, [&](const BlockOccupancy& block, const auto&... overlaps) {
      CountBlock(block, overlaps..., &counters);
    });
    return Decide(counters, options);
  }
  AnyVoxel any;
  ForEachFineBlock(fine, index, n, [&](const BlockOccupancy& block, const auto&... overlaps) {
    AddBlock(block, overlaps..., &any);
  });
  return Decide(any);
}

OccupancyMap Coarsen(const OccupancyMap& fine, const CoarsenOptions& options) {
  OccupancyMap coarse(fine.cell_size() * options.factor);
  const std::vector<BlockIndex> indices = CoarseBlocksOf(fine.SortedIndices(), options.factor);
  std::vector<BlockOccupancy> blocks(indices.size());
  ParallelFor(indices.size(), 8,
              [&](size_t i) { blocks[i] = CoarsenBlock(fine, indices[i], options); });
  for (size_t i = 0; i < indices.size(); ++i) coarse.Set(indices[i], blocks[i]);
  return coarse;
}

}  // namespace vismap
