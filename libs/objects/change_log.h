#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "map/block.h"

namespace vismap {

/// When each block of a map last changed. A follower that missed some updates gets the blocks that
/// changed since, and no others. Bounded: the changes that are longest ago are forgotten.
class ChangeLog {
 public:
  explicit ChangeLog(size_t max_blocks = 100000) : max_blocks_(max_blocks) {
    last_change_.max_load_factor(0.8F);  // there are up to max_blocks
  }

  /// The block changed at this revision of the map.
  void Record(int64_t revision, BlockIndex block);
  /// Starts again for a map without any change.
  void Clear();

  /// The blocks that changed after `revision`, ascending; nullopt when some of these changes are
  /// forgotten.
  std::optional<std::vector<BlockIndex>> Since(int64_t revision) const;
  /// Memory [bytes], about.
  size_t bytes() const { return last_change_.bucket_count() * (sizeof(BlockIndex) + 20); }

 private:
  void ForgetOldest();

  size_t max_blocks_;
  tsl::robin_map<BlockIndex, int64_t, BlockIndexHash> last_change_;
  int64_t complete_after_ = INT64_MIN;  // changes up to this revision are forgotten
};

}  // namespace vismap
