#include "map_server/change_log.h"

#include <algorithm>

namespace vismap {

std::vector<BlockIndex> ChangeLog::Since(int64_t revision) const {
  std::vector<BlockIndex> blocks;
  for (const auto& [block, changed] : last_change_) {
    if (changed > revision) blocks.push_back(block);
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

}  // namespace vismap
