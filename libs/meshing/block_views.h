#pragma once

#include <array>
#include <vector>

#include "map/block_rim.h"
#include "map/voxel_map.h"
#include "meshing/marching_cubes.h"
#include "meshing/mesh_kernels.h"

namespace vismap {

/// A block as marching cubes see it.
struct BlockView {
  BlockIndex index;
  const Block* block = nullptr;           ///< nullptr = unseen
  const SurfaceVoxels* voxels = nullptr;  ///< nullptr = none, or packed
  bool has_surface = false;
  /// Bits as in VoxelSigns; nullptr = none.
  const uint64_t* observed = nullptr;
  const uint64_t* behind = nullptr;
};

/// Blocks of a map that are about to be meshed, and those around them: each is looked up and read
/// once, though up to 27 cells grids need it. The map must not change meanwhile.
class BlockViews {
 public:
  /// `blocks` ascending.
  BlockViews(const VoxelMap& map, const std::vector<BlockIndex>& blocks);

  /// Those with surface voxels, ascending.
  std::vector<BlockIndex> WithSurface() const;
  /// Sets `observed` and `behind`.
  void ReadVoxels(const MeshingOptions& options);

  const std::vector<BlockView>& views() const { return views_; }

  /// The views of one x and y, ascending along z.
  struct Column {
    int32_t x = 0, y = 0;
    const BlockView* begin = nullptr;
    const BlockView* end = nullptr;
  };
  /// Ascending by x, then y.
  const std::vector<Column>& columns() const { return columns_; }

 private:
  std::vector<BlockView> views_;
  std::vector<Column> columns_;
  std::vector<VoxelSigns> signs_;  // of those with surface
};

/// Finds the 26 neighbours of one block after the other, in ascending order of blocks.
class NeighbourWalk {
 public:
  explicit NeighbourWalk(const BlockViews& views) : views_(views) {}

  /// Goes to a block; finds it and the seven neighbours that its cells reach into.
  void GoTo(BlockIndex block);
  /// Finds the other nineteen.
  void FindLower();
  /// The block that comes after this one of those with voxels behind the surface, so that it can be
  /// prefetched; nullptr = none.
  const BlockView* Next() const;
  /// Of a NeighbourSlot; never nullptr, unseen where there are no views. Slots not found are those
  /// of an earlier block.
  const BlockView& At(size_t slot) const { return *found_[slot]; }
  BlockIndex block() const { return block_; }

 private:
  void FindColumns();
  void FindAlong(int x, int y);

  const BlockViews& views_;
  BlockIndex block_;
  bool started_ = false;
  // Per column of neighbours along z what is left of it; the first view is not far below the block.
  struct Rest {
    const BlockView *begin = nullptr, *end = nullptr;
  };
  std::array<Rest, 9> rests_;
  std::array<const BlockView*, 27> found_{};
};

}  // namespace vismap
