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

// A neighbour of the block whose voxels its cells depend on.
struct Neighbour {
  int bx = 0, by = 0, bz = 0;
  size_t slot() const { return NeighbourSlot(bx, by, bz); }
};

// The block itself and those around it but for seven: normals ask for voxels below the block along
// one axis only. The middle columns first, while the others are on their way.
constexpr std::array<Neighbour, 20> ListNeighbours() {
  std::array<Neighbour, 20> neighbours;
  size_t count = 0;
  for (const int bx : {0, 1, -1}) {
    for (int i = 0; i < 9; ++i) {
      const Neighbour neighbour{bx, i / 3 - 1, i % 3 - 1};
      const int below = (bx < 0) + (neighbour.by < 0) + (neighbour.bz < 0);
      if (below < 2) neighbours[count++] = neighbour;
    }
  }
  return neighbours;
}
constexpr std::array<Neighbour, 20> kNeighbours = ListNeighbours();

constexpr bool LowerXComesLast() {
  for (size_t i = 1; i < kNeighbours.size(); ++i) {
    if (kNeighbours[i - 1].bx < 0 && kNeighbours[i].bx >= 0) return false;
  }
  return true;
}
static_assert(LowerXComesLast(), "what lies at upper x makes the first of the next row unseen");

// What some cells depend on along one axis: of the neighbour before, of the block, of the one
// behind, in the coordinates of each.
std::array<VoxelRange, 3> Overlaps(const CellBox::Range& cells) {
  std::array<VoxelRange, 3> overlaps;
  for (int i = 0; i < 3; ++i) {
    const int origin = kBlockSide * (i - 1);
    overlaps[static_cast<size_t>(i)] = {std::max(0, cells.from - 1 - origin),
                                        std::min(kBlockSide, cells.to + 2 - origin)};
  }
  return overlaps;
}
bool IsEmpty(const VoxelRange& range) { return range.begin >= range.end; }

// Rows of eight are read in order, which the processor foresees; columns are not.
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
  const auto first_layer = distances_.begin() + GridOffset(kGridLow, kGridLow, cells.z.from - 1);
  std::fill_n(first_layer, (cells.z.to - cells.z.from + 3) * kGridLayer, kUnseenDistance);
  const auto x = Overlaps(cells.x), y = Overlaps(cells.y), z = Overlaps(cells.z);
  for (const Neighbour& n : kNeighbours) {
    const VoxelRange& layers = z[static_cast<size_t>(n.bz + 1)];
    const uint64_t* observed = walk.At(n.slot()).observed;
    if (observed == nullptr || IsEmpty(layers) || IsEmpty(x[static_cast<size_t>(n.bx + 1)]) ||
        IsEmpty(y[static_cast<size_t>(n.by + 1)]))
      continue;
    const SurfaceVoxels* voxels = voxels_[n.slot()];
    const Distances& distances = voxels == nullptr ? kFreeDistances : voxels->distance;
    CopySeen(distances.data(), observed, {n.bx, n.by, layers},
             GridOffset(kBlockSide * n.bx, kBlockSide * n.by, kBlockSide * n.bz), &distances_);
  }
}

}  // namespace vismap
