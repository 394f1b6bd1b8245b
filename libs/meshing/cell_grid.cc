#include "meshing/cell_grid.h"

#include <algorithm>
#include <limits>

#include "base/prefetch.h"

namespace vismap {
namespace {

using Distances = std::array<int16_t, kBlockVoxels>;

constexpr Distances FreeDistances() {
  Distances distances{};
  distances.fill(std::numeric_limits<int16_t>::max());
  return distances;
}
constexpr Distances kFreeDistances = FreeDistances();
constexpr VoxelBits kNoneSeen{};

// The voxels that some cells depend on along one axis: in the block before, in the block itself,
// and in the block behind, each in its own coordinates.
std::array<CellBox::Range, 3> Overlaps(const CellBox::Range& cells) {
  std::array<CellBox::Range, 3> overlaps;
  for (int i = 0; i < 3; ++i) {
    const int origin = kBlockSide * (i - 1);
    overlaps[static_cast<size_t>(i)] = {std::max(0, cells.from - 1 - origin),
                                        std::min(kBlockSide, cells.to + 2 - origin)};
  }
  return overlaps;
}
bool IsEmpty(const CellBox::Range& range) { return range.from >= range.to; }

// For neighbours along x: of them only columns are read, which the processor does not prefetch.
void PrefetchDistances(const SurfaceVoxels* voxels) {
  if (voxels != nullptr) PrefetchAll(voxels->distance);
}

}  // namespace

void CellGrid::Prefetch(const SurfaceVoxels& voxels) {
  PrefetchDistances(&voxels);
  PrefetchLine(&voxels.palette);
}

void CellGrid::Fill(const NeighbourWalk& walk, const CellBox& cells, SurfaceReader* reader) {
  for (size_t slot = 0; slot < voxels_.size(); ++slot) {
    const BlockView& view = walk.At(slot);
    voxels_[slot] =
        view.has_surface && view.voxels == nullptr ? reader->Read(*view.block) : view.voxels;
  }
  for (int i = 0; i < 8; ++i) {
    upper_voxels_[static_cast<size_t>(i)] = voxels_[NeighbourSlot(i & 1, i >> 1 & 1, i >> 2)];
  }
  PrefetchDistances(voxels_[NeighbourSlot(-1, 0, 0)]);
  PrefetchDistances(voxels_[NeighbourSlot(1, 0, 0)]);
  const auto x = Overlaps(cells.x), y = Overlaps(cells.y), z = Overlaps(cells.z);
  for (int bz = -1; bz <= 1; ++bz) {
    const CellBox::Range& layers = z[static_cast<size_t>(bz + 1)];
    if (IsEmpty(layers)) continue;  // no cell depends on these neighbours
    SeenBlocks blocks;
    for (size_t i = 0; i < blocks.size(); ++i) {
      const size_t slot =
          NeighbourSlot(static_cast<int>(i % 3) - 1, static_cast<int>(i / 3) - 1, bz);
      const uint64_t* observed = walk.At(slot).observed;
      const SurfaceVoxels* voxels = voxels_[slot];
      const bool needed = observed != nullptr && !IsEmpty(x[i % 3]) && !IsEmpty(y[i / 3]);
      blocks[i] = {(needed && voxels != nullptr ? voxels->distance : kFreeDistances).data(),
                   needed ? observed : kNoneSeen.data()};
    }
    CopySeen(blocks, layers.from, layers.to, layers.from + kBlockSide * bz, distances_);
  }
}

}  // namespace vismap
