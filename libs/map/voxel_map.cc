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
  constexpr size_t kMaxChecked = 2048;  // blocks per call, so that no frame waits long
  std::vector<Block*> to_pack;
  for (size_t checked = 0; checked < kMaxChecked && unpacked_.size() > most; ++checked) {
    if (next_to_pack_ >= unpacked_.size()) next_to_pack_ = 0;
    Block* block = FindMutable(unpacked_[next_to_pack_]);
    if (block != nullptr && block->last_used >= before) {
      ++next_to_pack_;
      continue;
    }
    if (block != nullptr) {
      block->last_used = 0;
      to_pack.push_back(block);
    }
    unpacked_[next_to_pack_] = unpacked_.back();
    unpacked_.pop_back();
  }
  ParallelFor(to_pack.size(), 8, [&](size_t i) { to_pack[i]->surface.Pack(); });
}

VoxelMapMemory MeasureMemory(const VoxelMap& map) {
  VoxelMapMemory memory;
  memory.table_bytes = map.blocks().bytes();
  map.blocks().ForEach([&](BlockIndex, const Block& block) {
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
