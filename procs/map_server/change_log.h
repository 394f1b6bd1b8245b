#pragma once

#include <tsl/robin_map.h>

#include <cstdint>
#include <span>
#include <vector>

#include "volume/block.h"

namespace vismap {

/// When each block last changed in a stream of updates, so that a follower which missed some of
/// them is sent the blocks it lacks and no others.
class ChangeLog {
 public:
  void Record(int64_t revision, BlockIndex block) { last_change_[block] = revision; }
  void Clear() { last_change_.clear(); }

  /// Blocks that changed after `revision`, ascending.
  std::vector<BlockIndex> Since(int64_t revision) const;

 private:
  tsl::robin_map<BlockIndex, int64_t, BlockIndexHash> last_change_;
};

}  // namespace vismap
