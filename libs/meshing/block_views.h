#pragma once

#include <array>
#include <vector>

#include "map/block_rim.h"
#include "map/voxel_map.h"
#include "meshing/marching_cubes.h"
#include "meshing/mesh_kernels.h"

namespace vismap {

/// A block as marching cubes need it.
struct BlockView {
  BlockIndex index;
  const Block* block = nullptr;           ///< nullptr = unseen
  const SurfaceVoxels* voxels = nullptr;  ///< nullptr = there are none, or they are packed
  bool has_surface = false;
  const uint64_t* observed = nullptr;  ///< as in VoxelSigns; nullptr = no bit is set
  const uint64_t* behind = nullptr;    ///< as in VoxelSigns; nullptr = no bit is set
};

/// Blocks of a map that will be meshed and the blocks around them. Each is looked up and read once,
/// though up to 27 blocks need it. The map must not change during the lifetime of this object.
class BlockViews {
 public:
  /// `blocks` ascending.
  BlockViews(const VoxelMap& map, const std::vector<BlockIndex>& blocks);

  /// The blocks with surface voxels, ascending.
  std::vector<BlockIndex> WithSurface() const;
  /// Sets `observed` and `behind` of all views.
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
  std::vector<VoxelSigns> signs_;  // of the blocks with surface voxels
};

/// Finds the 26 neighbours of many blocks, one block after the other in ascending order.
class NeighbourWalk {
 public:
  explicit NeighbourWalk(const BlockViews& views) : views_(views) {}

  /// Goes to a block; finds the block and the seven neighbours that its cells reach into.
  void GoTo(BlockIndex block);
  /// Finds the other nineteen neighbours.
  void FindLower();
  /// The next block with voxels behind the surface, to prefetch it; nullptr = none.
  const BlockView* Next() const;
  /// The view in a NeighbourSlot; an unseen block where there is no view. Before FindLower, slots
  /// of the other nineteen still hold neighbours of an earlier block.
  const BlockView& At(size_t slot) const { return *found_[slot]; }
  BlockIndex block() const { return block_; }

 private:
  void FindColumns();
  void FindAlong(int x, int y);

  const BlockViews& views_;
  BlockIndex block_;
  bool started_ = false;
  // The rest of each column of neighbours along z; it begins near the block.
  struct Rest {
    const BlockView *begin = nullptr, *end = nullptr;
  };
  std::array<Rest, 9> rests_;
  std::array<const BlockView*, 27> found_{};
};

}  // namespace vismap
