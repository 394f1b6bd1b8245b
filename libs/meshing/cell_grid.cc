#include "meshing/cell_grid.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

namespace vismap {
namespace {

struct Range {
  int begin, end;  // local coordinates of the block that is being meshed
};

// Which of them lie in its neighbour at -1, 0 or +1.
Range Overlap(int neighbour) {
  if (neighbour < 0) return {-1, 0};
  if (neighbour > 0) return {kBlockSide, kBlockSide + 2};
  return {0, kBlockSide};
}

size_t NeighbourSlot(int bx, int by, int bz) {
  return static_cast<size_t>((bx + 1) + 3 * ((by + 1) + 3 * (bz + 1)));
}

struct Neighbour {
  int x = 0, y = 0, z = 0;
  size_t slot() const { return NeighbourSlot(x, y, z); }
};

// The block itself and the seven that its cells reach into, then the other nineteen.
constexpr size_t kUpperCount = 8;
constexpr std::array<Neighbour, 27> SortedNeighbours() {
  std::array<Neighbour, 27> sorted{};
  size_t upper = 0, lower = kUpperCount;
  for (int i = 0; i < 27; ++i) {
    const Neighbour n{i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    sorted[std::min({n.x, n.y, n.z}) >= 0 ? upper++ : lower++] = n;
  }
  return sorted;
}
constexpr std::array<Neighbour, 27> kNeighbours = SortedNeighbours();
constexpr std::span kUpper(kNeighbours.data(), kUpperCount);
constexpr std::span kLower(kNeighbours.data() + kUpperCount, kNeighbours.size() - kUpperCount);

int NeighbourOf(int local) { return local < 0 ? -1 : (local >= kBlockSide ? 1 : 0); }

// Free blocks remember no more than two observations, so no more can be asked of them.
bool FreeVoxelObserved(const Block& block, int offset, int min_observations) {
  if (block.all_free) return true;
  if (!block.free) return false;
  return min_observations <= 1 ? block.free->SeenOnce(offset) : block.free->SeenTwice(offset);
}

// Weights above this many steps count.
int WeightGate(double min_weight) {
  return static_cast<int>(std::clamp(min_weight * static_cast<double>(kWeightScale), 0.0, 65535.0));
}

// Voxels that follow each other along x, from one array into the other.
void CopySurfaceRow(const SurfaceVoxels& voxels, int offset, int length, int weight_gate,
                    int min_observations, int16_t* distance, uint8_t* observed) {
  const auto from = static_cast<size_t>(offset);
  std::copy_n(&voxels.distance[from], length, distance);
  for (int i = 0; i < length; ++i) {
    const size_t voxel = from + static_cast<size_t>(i);
    observed[i] = static_cast<uint8_t>((voxels.weight[voxel] > weight_gate) &
                                       (voxels.observations[voxel] >= min_observations));
  }
}

}  // namespace

CellGrid::CellGrid(const VoxelMap& map, BlockIndex block, const MeshingOptions& options,
                   SurfaceReader* reader)
    : block_(block) {
  const auto find = [&](const Neighbour& n) {
    const Block* found = map.Find({block.x + n.x, block.y + n.y, block.z + n.z});
    blocks_[n.slot()] = found;
    return found != nullptr && found->surface;
  };
  int with_surface = 0;
  for (const Neighbour& n : kUpper) with_surface += find(n);
  if (with_surface == 0) return;
  for (const Neighbour& n : kUpper) CopyNeighbour(n.x, n.y, n.z, options, reader);
  FillRows();
  if (!HasSurface()) return;
  for (const Neighbour& n : kLower) {
    find(n);
    CopyNeighbour(n.x, n.y, n.z, options, reader);
  }
}

void CellGrid::CopyNeighbour(int bx, int by, int bz, const MeshingOptions& options,
                             SurfaceReader* reader) {
  const size_t slot = NeighbourSlot(bx, by, bz);
  const Block* block = blocks_[slot];
  if (block == nullptr) return;
  const SurfaceVoxels* voxels = voxels_[slot] = reader->Read(*block);
  const Range xs = Overlap(bx), ys = Overlap(by), zs = Overlap(bz);
  const int weight_gate = WeightGate(options.min_weight);
  const int length = xs.end - xs.begin;
  for (int z = zs.begin; z < zs.end; ++z) {
    for (int y = ys.begin; y < ys.end; ++y) {
      const size_t target = Offset(xs.begin, y, z);
      const int offset = LinearIndex(xs.begin & 7, y & 7, z & 7);
      if (voxels != nullptr) {
        CopySurfaceRow(*voxels, offset, length, weight_gate, options.min_observations,
                       &distance_[target], &observed_[target]);
      } else {
        std::fill_n(&distance_[target], length, std::numeric_limits<int16_t>::max());
        for (int i = 0; i < length; ++i) {
          observed_[target + static_cast<size_t>(i)] =
              FreeVoxelObserved(*block, offset + i, options.min_observations);
        }
      }
    }
  }
}

void CellGrid::FillRows() {
  for (int z = 0; z < kCorners; ++z) {
    for (int y = 0; y < kCorners; ++y) {
      uint32_t observed = 0, behind = 0;
      for (int x = 0; x < kCorners; ++x) {
        const uint32_t bit = 1u << x;
        if (!Observed(x, y, z)) continue;
        observed |= bit;
        if (Distance(x, y, z) < 0) behind |= bit;
      }
      observed_row_[RowOf(y, z)] = observed;
      behind_row_[RowOf(y, z)] = behind;
      any_behind_ |= behind != 0;
      any_front_ |= (observed & ~behind) != 0;
    }
  }
}

CellGrid::Place CellGrid::At(int x, int y, int z) const {
  const SurfaceVoxels* voxels =
      voxels_[NeighbourSlot(NeighbourOf(x), NeighbourOf(y), NeighbourOf(z))];
  if (voxels == nullptr) return {};
  return {voxels, LinearIndex(x & 7, y & 7, z & 7)};
}

}  // namespace vismap
