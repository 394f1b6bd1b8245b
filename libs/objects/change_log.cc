#include "objects/change_log.h"

#include <algorithm>

namespace vismap {

void ChangeLog::Record(int64_t revision, BlockIndex block) {
  last_change_[block] = revision;
  if (last_change_.size() > max_blocks_) ForgetOldest();
}

void ChangeLog::Clear() {
  last_change_.clear();
  complete_after_ = INT64_MIN;
}

void ChangeLog::ForgetOldest() {
  std::vector<int64_t> revisions;
  for (const auto& entry : last_change_) revisions.push_back(entry.second);
  const auto middle = revisions.begin() + static_cast<std::ptrdiff_t>(revisions.size() / 2);
  std::nth_element(revisions.begin(), middle, revisions.end());
  complete_after_ = *middle;
  for (auto entry = last_change_.begin(); entry != last_change_.end();) {
    entry = entry->second <= complete_after_ ? last_change_.erase(entry) : std::next(entry);
  }
}

std::optional<std::vector<BlockIndex>> ChangeLog::Since(int64_t revision) const {
  if (revision < complete_after_) return std::nullopt;
  std::vector<BlockIndex> blocks;
  for (const auto& [block, changed] : last_change_) {
    if (changed > revision) blocks.push_back(block);
  }
  std::sort(blocks.begin(), blocks.end());
  return blocks;
}

}  // namespace vismap
