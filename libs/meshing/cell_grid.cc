#include "meshing/cell_grid.h"

#include <limits>

namespace vismap {
namespace {

constexpr float kFreeDistance = std::numeric_limits<int16_t>::max();

// What of a neighbour lies in the grid, along one axis: in the neighbour's own coordinates.
struct Range {
  int begin, end;
};
Range Overlap(int neighbour) {
  if (neighbour < 0) return {kBlockSide - 1, kBlockSide};
  if (neighbour > 0) return {0, 2};
  return {0, kBlockSide};
}

int NeighbourOf(int local) { return local < 0 ? -1 : local / kBlockSide; }

}  // namespace

struct CellGrid::Neighbour {
  int bx, by, bz;
  Range x = Overlap(bx), y = Overlap(by), z = Overlap(bz);

  size_t slot() const { return NeighbourWalk::Slot(bx, by, bz); }
  size_t GridAt(int vx, int vy, int vz) const {
    return static_cast<size_t>(
        GridOffset(kBlockSide * bx + vx, kBlockSide * by + vy, kBlockSide * bz + vz));
  }
};

void CellGrid::Fill(const NeighbourWalk& walk, const ObservationGate& gate, SurfaceReader* reader) {
  distances_.fill(kUnseenDistance);
  for (int i = 0; i < 27; ++i) {
    const Neighbour neighbour{i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1};
    const size_t slot = neighbour.slot();
    const BlockView& view = walk.At(slot);
    voxels_[slot] = view.has_surface() ? reader->Read(*view.block) : nullptr;
    if (voxels_[slot] != nullptr) {
      CopySurface(neighbour, gate);
    } else if (view.observed != nullptr) {
      CopyFree(neighbour, view.observed);
    }
  }
}

void CellGrid::CopySurface(const Neighbour& n, const ObservationGate& gate) {
  const SurfaceVoxels& voxels = *voxels_[n.slot()];
  if (n.bx == 0) {
    const RowRange rows{LinearIndex(0, n.y.begin, n.z.begin), n.y.end - n.y.begin,
                        n.z.end - n.z.begin};
    CopyRows(voxels, gate, rows, &distances_[n.GridAt(0, n.y.begin, n.z.begin)]);
    return;
  }
  for (int z = n.z.begin; z < n.z.end; ++z) {
    for (int y = n.y.begin; y < n.y.end; ++y) {
      for (int x = n.x.begin; x < n.x.end; ++x) {
        const auto voxel = static_cast<size_t>(LinearIndex(x, y, z));
        distances_[n.GridAt(x, y, z)] = GridDistance(voxels, gate, voxel);
      }
    }
  }
}

void CellGrid::CopyFree(const Neighbour& n, const uint64_t* observed) {
  for (int z = n.z.begin; z < n.z.end; ++z) {
    for (int y = n.y.begin; y < n.y.end; ++y) {
      for (int x = n.x.begin; x < n.x.end; ++x) {
        if ((observed[z] >> (x + kBlockSide * y)) & 1)
          distances_[n.GridAt(x, y, z)] = kFreeDistance;
      }
    }
  }
}

CellGrid::Place CellGrid::PlaceOf(int x, int y, int z) const {
  const SurfaceVoxels* voxels =
      voxels_[NeighbourWalk::Slot(NeighbourOf(x), NeighbourOf(y), NeighbourOf(z))];
  if (voxels == nullptr) return {};
  return {voxels, LinearIndex(x & 7, y & 7, z & 7)};
}

}  // namespace vismap
