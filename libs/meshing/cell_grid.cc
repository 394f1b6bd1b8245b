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

void CellGrid::Fill(const NeighbourWalk& walk, SurfaceReader* reader) {
  distances_.fill(kUnseenDistance);
  for (int i = 0; i < 27; ++i) {
    const Neighbour neighbour{i / 9 - 1, i / 3 % 3 - 1, i % 3 - 1};
    const BlockView& view = walk.At(neighbour.slot());
    const SurfaceVoxels* voxels = view.has_surface() ? reader->Read(*view.block) : nullptr;
    voxels_[neighbour.slot()] = voxels;
    if (view.observed == nullptr) continue;
    if (voxels == nullptr) {
      CopyVoxels(neighbour, view.observed, [](size_t) { return kFreeDistance; });
    } else if (neighbour.bx == 0) {
      CopyRows(neighbour, *voxels, view.observed);
    } else {
      const auto& distances = voxels->distance;
      CopyVoxels(neighbour, view.observed,
                 [&](size_t voxel) { return static_cast<float>(distances[voxel]); });
    }
  }
}

void CellGrid::CopyRows(const Neighbour& n, const SurfaceVoxels& voxels, const uint64_t* observed) {
  for (int z = n.z.begin; z < n.z.end; ++z) {
    const auto first = static_cast<size_t>(LinearIndex(0, n.y.begin, z));
    CopyLayer(&voxels.distance[first], observed[z] >> (kBlockSide * n.y.begin),
              n.y.end - n.y.begin, &distances_[n.GridAt(0, n.y.begin, z)]);
  }
}

template <typename Distance>
void CellGrid::CopyVoxels(const Neighbour& n, const uint64_t* observed, const Distance& distance) {
  for (int z = n.z.begin; z < n.z.end; ++z) {
    for (int y = n.y.begin; y < n.y.end; ++y) {
      for (int x = n.x.begin; x < n.x.end; ++x) {
        const int voxel = LinearIndex(x, y, 0);
        if ((observed[z] >> voxel & 1) == 0) continue;
        distances_[n.GridAt(x, y, z)] = distance(static_cast<size_t>(voxel + LinearIndex(0, 0, z)));
      }
    }
  }
}

}  // namespace vismap
