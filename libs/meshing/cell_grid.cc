#include "meshing/cell_grid.h"

#include <algorithm>
#include <limits>

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

}  // namespace

CellGrid::CellGrid(const VoxelMap& map, BlockIndex block, const MeshingOptions& options)
    : block_(block) {
  for (int bz = -1; bz <= 1; ++bz) {
    for (int by = -1; by <= 1; ++by) {
      for (int bx = -1; bx <= 1; ++bx) {
        const Block* neighbour = map.Find({block.x + bx, block.y + by, block.z + bz});
        if (neighbour == nullptr) continue;
        blocks_[NeighbourSlot(bx, by, bz)] = neighbour;
        CopyBlock(*neighbour, bx, by, bz, options);
      }
    }
  }
  FillRows();
}

void CellGrid::CopyBlock(const Block& block, int bx, int by, int bz,
                         const MeshingOptions& options) {
  const Range xs = Overlap(bx), ys = Overlap(by), zs = Overlap(bz);
  const int weight_gate = WeightGate(options.min_weight);
  for (int z = zs.begin; z < zs.end; ++z) {
    for (int y = ys.begin; y < ys.end; ++y) {
      for (int x = xs.begin; x < xs.end; ++x) {
        const int offset = LinearIndex(x & 7, y & 7, z & 7);
        const auto source = static_cast<size_t>(offset);
        const size_t target = Offset(x, y, z);
        if (block.surface) {
          const SurfaceVoxels& voxels = *block.surface;
          distance_[target] = voxels.distance[source];
          observed_[target] = voxels.weight[source] > weight_gate &&
                              voxels.observations[source] >= options.min_observations;
        } else {
          distance_[target] = std::numeric_limits<int16_t>::max();
          observed_[target] = FreeVoxelObserved(block, offset, options.min_observations);
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
  const Block* block = blocks_[NeighbourSlot(NeighbourOf(x), NeighbourOf(y), NeighbourOf(z))];
  if (block == nullptr || !block->surface) return {};
  return {block->surface.get(), LinearIndex(x & 7, y & 7, z & 7)};
}

}  // namespace vismap
