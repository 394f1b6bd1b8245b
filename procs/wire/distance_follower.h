#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "map/block_table.h"
#include "wire/distance_update.h"

namespace vismap {

/// Blocks with their distances, ascending by index. What a pointer leads to never changes.
using SharedDistanceBlocks =
    std::vector<std::pair<BlockIndex, std::shared_ptr<const BlockDistances>>>;

/// A copy of the exporter's distances, built from the messages on DISTANCES, equal to them bit for
/// bit. It detects a missing update and then reports kNeedsSnapshot: ask for it with the verb
/// distances-delta. Memory is bounded, see FollowLimits; a field that needs more is dropped and
/// reported as kTooLarge.
class DistanceFollower {
 public:
  explicit DistanceFollower(const FollowLimits& limits = {}) : sequence_(limits) {}

  /// Adds one part of an update at time `now` [s]; the copy changes when the last part has arrived.
  FollowOutcome Apply(DistanceUpdate update, double now = 0);

  /// The distances at the centres of a block's leaves; nullopt for a block that is unknown
  /// everywhere, where the distance to unknown space is 0.
  std::optional<BlockDistances> At(BlockIndex index) const;
  std::vector<BlockIndex> SortedIndices() const { return blocks_.SortedIndices(); }
  /// The present state, which later updates leave as it is. Costs time and memory for pointers
  /// only.
  SharedDistanceBlocks Share() const;

  double leaf_m() const { return leaf_m_; }    ///< 0 before the first update
  double limit_m() const { return limit_m_; }  ///< distances are exact up to here

  /// Drops the parts of an update whose other parts do not come. Returns how many.
  size_t GiveUpStaleParts(double now) { return sequence_.GiveUpStaleParts(now); }
  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }  ///< of the newest frame contained [us]
  int64_t gaps() const { return sequence_.gaps(); }

 private:
  void ApplyPart(DistanceUpdate part);

  UpdateSequence<DistanceUpdate> sequence_;
  BlockTable<std::shared_ptr<const BlockDistances>> blocks_;
  double leaf_m_ = 0, limit_m_ = 0;
  int64_t utime_ = 0;
};

}  // namespace vismap
