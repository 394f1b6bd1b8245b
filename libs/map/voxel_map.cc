#include "map/voxel_map.h"

#include <cmath>

#include "base/parallel.h"
#include "map/surface_reader.h"

namespace vismap {

void VoxelMap::MarkUsed(BlockIndex index, Block& block, uint32_t now) {
  if (block.last_used == 0) unpacked_.push_back(index);
  block.last_used = now;
}

void VoxelMap::PackUnused(uint32_t before, size_t most) {
  // Checks a limited number of blocks per call, so that no frame waits long; but all that are too
  // many when a camera brings more new blocks with every frame.
  constexpr size_t kMaxChecked = 2048;
  const size_t too_many = unpacked_.size() > 2 * most ? unpacked_.size() - 2 * most : 0;
  std::vector<Block*> to_pack;
  for (size_t checked = 0; checked < kMaxChecked + too_many && unpacked_.size() > most; ++checked) {
    if (next_to_pack_ >= unpacked_.size()) next_to_pack_ = 0;
    // Looking for a block to change copies a part of the table when a copy of the map shares it.
    const BlockIndex index = unpacked_[next_to_pack_];
    const Block* block = Find(index);
    if (block != nullptr && block->last_used >= before) {
      ++next_to_pack_;
      continue;
    }
    if (block != nullptr) {
      to_pack.push_back(FindMutable(index));
      to_pack.back()->last_used = 0;
    }
    unpacked_[next_to_pack_] = unpacked_.back();
    unpacked_.pop_back();
  }
  for (const Block* block : to_pack) CountBytes(BytesOf(*block), 0);
  ParallelFor(to_pack.size(), 8, [&](size_t i) { to_pack[i]->surface.Pack(); });
  for (const Block* block : to_pack) CountBytes(0, BytesOf(*block));
}

size_t BytesOf(const Block& block) {
  constexpr size_t kPalette = 64;  // rarely more; looking would cost a cache miss
  const size_t thin = block.thin ? sizeof(ThinVoxels) : 0;
  if (block.surface.packed()) return block.surface.packed_bytes() + thin;
  if (block.surface) return sizeof(SurfaceVoxels) + kPalette + thin;
  return (block.free ? sizeof(FreeVoxels) : 0) + thin;
}

VoxelMapMemory MeasureMemory(const VoxelMap& map) {
  VoxelMapMemory memory;
  memory.table_bytes = map.blocks().bytes();
  map.blocks().ForEach([&](BlockIndex, const Block& block) {
    if (block.thin) memory.free_bytes += sizeof(ThinVoxels);
    if (block.surface) {
      ++memory.surface_blocks;
      if (block.surface.packed()) {
        ++memory.packed_blocks;
        memory.packed_bytes += block.surface.packed_bytes();
        return;
      }
      const SurfaceVoxels& voxels = *block.surface;
      memory.tsdf_bytes +=
          sizeof(voxels.distance) + sizeof(voxels.weight) + sizeof(voxels.observations);
      memory.color_bytes += sizeof(voxels.color);
      memory.label_bytes += sizeof(voxels.slot_label) + sizeof(voxels.slot_votes) +
                            sizeof(voxels.palette) +
                            voxels.palette.capacity() * sizeof(SegmentLabel);
    } else if (block.free) {
      ++memory.free_blocks;
      memory.free_bytes += sizeof(FreeVoxels);
    } else {
      ++memory.all_free_blocks;
    }
  });
  return memory;
}

}  // namespace vismap
