#pragma once

#include <cstdint>
#include <vector>

#include "map/block_rim.h"
#include "map/voxel_map.h"

namespace vismap {

/// Collects the blocks that changed until their surface is meshed again.
class DirtyBlocks {
 public:
  void Add(const BlockChanges& changes);
  bool empty() const { return dirty_.empty(); }
  void Clear() { dirty_.clear(); }
  size_t bytes() const { return dirty_.capacity() * sizeof(Dirty); }  ///< memory
  /// The blocks whose surface may differ now, ascending (see BlocksToMesh); none is dirty after it.
  std::vector<BlockIndex> TakeBlocksToMesh(const VoxelMap& map);

 private:
  struct Dirty {
    BlockIndex block;
    NeighbourBits affected = 0;
  };

  std::vector<Dirty> dirty_;  // unsorted; a block may be in it several times
};

}  // namespace vismap
