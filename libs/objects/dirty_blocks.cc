#include "objects/dirty_blocks.h"

#include <algorithm>

#include "meshing/marching_cubes.h"

namespace vismap {

void DirtyBlocks::Add(const BlockChanges& changes) {
  for (size_t i = 0; i < changes.blocks.size(); ++i) {
    dirty_.push_back(
        {changes.blocks[i], changes.affected.empty() ? kAllNeighbours : changes.affected[i]});
  }
}

std::vector<BlockIndex> DirtyBlocks::TakeBlocksToMesh(const VoxelMap& map) {
  std::sort(dirty_.begin(), dirty_.end(),
            [](const Dirty& a, const Dirty& b) { return a.block < b.block; });
  std::vector<BlockIndex> blocks;
  std::vector<NeighbourBits> affected;
  for (const Dirty& dirty : dirty_) {
    if (blocks.empty() || blocks.back() != dirty.block) {
      blocks.push_back(dirty.block);
      affected.push_back(0);
    }
    affected.back() |= dirty.affected;
  }
  dirty_.clear();
  return BlocksToMesh(map, {blocks, affected});
}

}  // namespace vismap
