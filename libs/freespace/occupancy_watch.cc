#include "freespace/occupancy_watch.h"

#include <algorithm>
#include <bit>

namespace vismap {

void OccupancyWatch::Clear() {
  entries_.clear();
  digest_ = {};
}

OccupancyDelta OccupancyWatch::Update(const SemanticMap& map, std::span<const BlockIndex> changed) {
  OccupancyDelta delta = ClassifyBlocks(map, changed, options_);
  std::erase_if(delta.blocks, [&](const auto& block) {
    const uint64_t now = ChecksumOf(block.first, block.second);
    const auto found = entries_.find(block.first);
    const uint64_t before =
        found == entries_.end() ? 0 : std::bit_cast<uint64_t>(found->second.checksum);
    if (now == before) return true;
    entries_[block.first] = {static_cast<uint32_t>(map.revision),
                             std::bit_cast<std::array<uint32_t, 2>>(now)};
    digest_.Replace(before, now);
    return false;
  });
  return delta;
}

std::vector<BlockIndex> OccupancyWatch::ChangedAfter(int64_t revision) const {
  std::vector<BlockIndex> blocks;
  for (const auto& [block, entry] : entries_) {
    if (entry.revision > revision) blocks.push_back(block);
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

}  // namespace vismap
