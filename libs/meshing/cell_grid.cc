#include "meshing/cell_grid.h"

#include <algorithm>
#include <limits>

namespace vismap {
namespace {

constexpr int16_t kFreeDistance = std::numeric_limits<int16_t>::max();

// What of a neighbour some cells depend on, along one axis: in the neighbour's own coordinates.
VoxelRange Overlap(int neighbour, const CellBox::Range& cells) {
  const int origin = kBlockSide * neighbour;
  return {std::max(0, cells.from - 1 - origin), std::min(kBlockSide, cells.to + 2 - origin)};
}

// Rows of eight are read in order, which the processor foresees; columns are not.
void PrefetchDistances(const SurfaceVoxels* voxels) {
  constexpr size_t kPerLine = 64 / sizeof(int16_t);
  if (voxels == nullptr) return;
  for (size_t i = 0; i < kBlockVoxels; i += kPerLine) __builtin_prefetch(&voxels->distance[i]);
}

}  // namespace

struct CellGrid::Neighbour {
  int bx, by, bz;
  VoxelRange x, y, z;

  // Normals ask for voxels beside the corners of cells, along one axis only.
  bool IsBesideCells() const { return (bx < 0) + (by < 0) + (bz < 0) < 2; }
  bool IsEmpty() const { return x.begin >= x.end || y.begin >= y.end || z.begin >= z.end; }
  size_t slot() const { return NeighbourWalk::Slot(bx, by, bz); }
  size_t GridAt(int vx, int vy, int vz) const {
    return static_cast<size_t>(
        GridOffset(kBlockSide * bx + vx, kBlockSide * by + vy, kBlockSide * bz + vz));
  }
};

void CellGrid::Fill(const NeighbourWalk& walk, const CellBox& cells, SurfaceReader* reader) {
  for (size_t slot = 0; slot < voxels_.size(); ++slot) {
    const BlockView& view = walk.At(slot);
    voxels_[slot] =
        view.has_surface && view.voxels == nullptr ? reader->Read(*view.block) : view.voxels;
  }
  PrefetchDistances(voxels_[NeighbourWalk::Slot(-1, 0, 0)]);
  PrefetchDistances(voxels_[NeighbourWalk::Slot(1, 0, 0)]);
  const auto first_layer = distances_.begin() + GridOffset(kGridLow, kGridLow, cells.z.from - 1);
  std::fill_n(first_layer, (cells.z.to - cells.z.from + 3) * kGridLayer, kUnseenDistance);
  // The middle columns first, while the others are on their way.
  for (const int bx : {0, -1, 1}) {
    for (int i = 0; i < 9; ++i) {
      const int by = i / 3 - 1, bz = i % 3 - 1;
      const Neighbour neighbour{
          bx, by, bz, Overlap(bx, cells.x), Overlap(by, cells.y), Overlap(bz, cells.z)};
      if (!neighbour.IsBesideCells() || neighbour.IsEmpty()) continue;
      const uint64_t* observed = walk.At(neighbour.slot()).observed;
      if (observed != nullptr) CopyNeighbour(neighbour, observed);
    }
  }
}

void CellGrid::CopyNeighbour(const Neighbour& n, const uint64_t* observed) {
  const SurfaceVoxels* voxels = voxels_[n.slot()];
  if (voxels == nullptr) {
    CopyFree(n, observed);
  } else if (n.bx == 0) {
    CopyRows(n, *voxels, observed);
  } else if (n.bx < 0) {
    CopyColumns<kBlockSide - 1, 1>(n, *voxels, observed);
  } else {
    CopyColumns<0, 2>(n, *voxels, observed);
  }
}

void CellGrid::CopyRows(const Neighbour& n, const SurfaceVoxels& voxels, const uint64_t* observed) {
  CopySeenRows(voxels.distance.data(), observed, n.y, n.z, &distances_[n.GridAt(0, 0, 0)]);
}

template <int kFrom, int kCount>
void CellGrid::CopyColumns(const Neighbour& n, const SurfaceVoxels& voxels,
                           const uint64_t* observed) {
  for (int z = n.z.begin; z < n.z.end; ++z) {
    const int16_t* from = &voxels.distance[static_cast<size_t>(LinearIndex(kFrom, 0, z))];
    int16_t* to = &distances_[n.GridAt(kFrom, n.y.begin, z)];
    for (int y = n.y.begin; y < n.y.end; ++y, to += kGridRow) {
      const uint64_t bits = observed[z] >> (kBlockSide * y + kFrom);
      for (int x = 0; x < kCount; ++x) {
        to[x] = (bits >> x & 1) != 0 ? from[kBlockSide * y + x] : kUnseenDistance;
      }
    }
  }
}

void CellGrid::CopyFree(const Neighbour& n, const uint64_t* observed) {
  for (int z = n.z.begin; z < n.z.end; ++z) {
    for (int y = n.y.begin; y < n.y.end; ++y) {
      for (int x = n.x.begin; x < n.x.end; ++x) {
        const bool seen = (observed[z] >> LinearIndex(x, y, 0) & 1) != 0;
        distances_[n.GridAt(x, y, z)] = seen ? kFreeDistance : kUnseenDistance;
      }
    }
  }
}

}  // namespace vismap
