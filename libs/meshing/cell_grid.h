#pragma once

#include <array>
#include <cstdint>

#include "meshing/marching_cubes.h"
#include "volume/surface_reader.h"

namespace vismap {

/// The voxels of one block and a rim around it (one voxel below, two above), copied from up to 27
/// blocks: all that the surface of the block's cells depends on. Coordinates are local to the
/// block, -1..9.
class CellGrid {
 public:
  static constexpr int kLow = -1;
  static constexpr int kSide = kBlockSide + 3;
  /// Cell corners per axis: 0..8.
  static constexpr int kCorners = kBlockSide + 1;

  /// Copies the corners first, and the rim only if a surface runs between them: most blocks have
  /// none. Without a surface only HasSurface() may be asked. Good for as long as what `reader`
  /// read.
  CellGrid(const VoxelMap& map, BlockIndex block, const MeshingOptions& options,
           SurfaceReader* reader);

  /// One bit per x = 0..8 of a row of corners: seen at all, and behind the surface.
  uint32_t ObservedRow(int y, int z) const { return observed_row_[RowOf(y, z)]; }
  uint32_t BehindRow(int y, int z) const { return behind_row_[RowOf(y, z)]; }
  bool HasSurface() const { return any_behind_ && any_front_; }

  bool Observed(int x, int y, int z) const { return observed_[Offset(x, y, z)] != 0; }
  /// Signed distance in steps of truncation / 32767.
  int16_t Distance(int x, int y, int z) const { return distance_[Offset(x, y, z)]; }

  /// The surface voxels that hold (x, y, z), and its offset there; nullptr in free or unseen
  /// blocks.
  struct Place {
    const SurfaceVoxels* voxels = nullptr;
    int offset = 0;
  };
  Place At(int x, int y, int z) const;

  BlockIndex block() const { return block_; }

 private:
  static size_t Offset(int x, int y, int z) {
    return static_cast<size_t>((x - kLow) + kSide * ((y - kLow) + kSide * (z - kLow)));
  }
  static size_t RowOf(int y, int z) { return static_cast<size_t>(y + kCorners * z); }
  void CopyNeighbour(int bx, int by, int bz, const MeshingOptions& options, SurfaceReader* reader);
  void FillRows();

  BlockIndex block_;
  std::array<const Block*, 27> blocks_{};
  std::array<const SurfaceVoxels*, 27> voxels_{};  // of those that were read
  std::array<int16_t, kSide * kSide * kSide> distance_;
  std::array<uint8_t, kSide * kSide * kSide> observed_{};
  std::array<uint32_t, kCorners * kCorners> observed_row_;
  std::array<uint32_t, kCorners * kCorners> behind_row_;
  bool any_behind_ = false;
  bool any_front_ = false;
};

}  // namespace vismap
