#pragma once

#include <optional>
#include <span>

#include "map/block_table.h"
#include "navigation/distance_field.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "wire/distance_update.h"

namespace vismap {

/// Keeps the distances of a map of leaves up to date, and publishes what changes on DISTANCES, so
/// that followers which may miss messages can always end with exactly the same field.
class DistancePublisher {
 public:
  /// `limit_m`: see DistanceOptions; 0 = it does nothing. `bus` must outlive it.
  DistancePublisher(double limit_m, Bus* bus) : limit_m_(limit_m), bus_(bus) {}

  /// Must be called with the blocks of `leaves` that changed since the last call, all blocks after
  /// Clear. Fails on a limit that is out of range.
  Result<void> Update(const FollowerPosition& position, int64_t utime, const OccupancyMap& leaves,
                      std::span<const BlockIndex> changed);
  /// What a follower at `position` lacks: the blocks that changed since, or everything. Fails when
  /// no distances are kept.
  Result<void> PublishSince(const FollowerPosition& position);
  /// The present revision without a change, when nothing else was said for a second.
  void Heartbeat();
  /// The map is gone; nothing is published until the next Update.
  void Clear();

  /// The field; nullptr when none is kept.
  const DistanceField* field() const { return field_ ? &*field_ : nullptr; }
  /// What followers reach by what was published, the newest frame in it, and when it was sent [us].
  const FollowerPosition& position() const { return position_; }
  int64_t utime() const { return utime_; }
  int64_t published_utime() const { return published_utime_; }

 private:
  void Publish(int64_t base_revision, std::span<const BlockIndex> blocks);

  double limit_m_;
  Bus* bus_;
  std::optional<DistanceField> field_;
  FollowerPosition position_;  // that followers reach by what was published
  int64_t utime_ = 0, published_utime_ = 0;
  BlockTable<int64_t> revisions_;  // of the last change of each block
  Pacer heartbeat_pacer_{1.0};
};

}  // namespace vismap
