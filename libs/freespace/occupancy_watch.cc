#include "freespace/occupancy_watch.h"

#include <algorithm>
#include <bit>

namespace vismap {

void OccupancyWatch::Clear() {
  entries_.Clear();
  digest_ = {};
}

OccupancyDelta OccupancyWatch::Update(const SemanticMap& map, std::span<const BlockIndex> changed) {
  OccupancyDelta delta = ClassifyBlocks(map, changed, options_);
  std::erase_if(delta.blocks, [&](const auto& block) {
    const uint64_t now = ChecksumOf(block.first, block.second);
    const Entry* entry = entries_.Find(block.first);
    const uint64_t before = entry == nullptr ? 0 : std::bit_cast<uint64_t>(entry->checksum);
    if (now == before) return true;
    entries_.FindOrCreate(block.first) = {static_cast<uint32_t>(map.revision),
                                          std::bit_cast<std::array<uint32_t, 2>>(now)};
    digest_.Replace(before, now);
    return false;
  });
  return delta;
}

std::vector<BlockIndex> OccupancyWatch::ChangedAfter(int64_t revision) const {
  std::vector<BlockIndex> blocks;
  entries_.ForEach([&](BlockIndex block, const Entry& entry) {
    if (entry.revision > revision) blocks.push_back(block);
  });
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

}  // namespace vismap
