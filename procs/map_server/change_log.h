#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "map/block.h"

namespace vismap {

/// When each block last changed in a stream of updates, so that a follower which missed some of
/// them is sent the blocks it lacks and no others. Bounded: what changed longest ago is forgotten.
class ChangeLog {
 public:
  explicit ChangeLog(size_t max_blocks = 100000) : max_blocks_(max_blocks) {
    last_change_.max_load_factor(0.8F);  // there are up to max_blocks
  }

  void Record(int64_t revision, BlockIndex block);
  /// Forgets everything; nothing had changed before.
  void Clear();

  /// Blocks that changed after `revision`, ascending; nullopt when that is forgotten.
  std::optional<std::vector<BlockIndex>> Since(int64_t revision) const;

 private:
  void ForgetOldest();

  size_t max_blocks_;
  tsl::robin_map<BlockIndex, int64_t, BlockIndexHash> last_change_;
  int64_t complete_after_ = INT64_MIN;  // changes up to this revision are forgotten
};

}  // namespace vismap
