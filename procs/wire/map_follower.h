#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "freespace/occupancy_map.h"
#include "wire/map_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// The region of a map whose occupancy may have changed since an earlier time.
struct OccupancyChanges {
  bool everywhere = false;         ///< the whole map, also blocks that no longer exist
  std::vector<BlockIndex> blocks;  ///< in ascending order; empty when `everywhere`
};

/// A copy of the occupancy of the server's map, built from its MAP_DELTA updates. It detects a
/// missing update and then reports kNeedsSnapshot; it keeps the last consistent state until the
/// missing data has arrived completely. Its memory is bounded, see FollowLimits; a map that needs
/// more is dropped and reported as kTooLarge.
class MapFollower {
 public:
  explicit MapFollower(const FollowLimits& limits = {}) : sequence_(limits) {}

  /// Adds one part of an update at time `now` [s]; the copy changes when the last part has arrived.
  FollowOutcome Apply(MapUpdate update, double now = 0);

  /// Only a snapshot can be applied next; until it comes, the copy stays as it is.
  void RequireSnapshot() { sequence_.RequireSnapshot(); }
  /// Drops the parts of an update whose other parts do not come. Returns how many.
  size_t GiveUpStaleParts(double now) { return sequence_.GiveUpStaleParts(now); }
  /// Memory of the copy and of the parts that wait [bytes].
  size_t bytes() const { return sequence_.staged_bytes() + (occupancy_ ? occupancy_->bytes() : 0); }

  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }  ///< of the newest frame contained [us]
  /// nullopt before the first snapshot.
  const std::optional<OccupancyMap>& occupancy() const { return occupancy_; }
  int64_t gaps() const { return sequence_.gaps(); }  ///< how often an update was missing

  /// The changes since the last call, which it then forgets. `everywhere` at the first call and
  /// after a snapshot.
  OccupancyChanges ConsumeChanges();

 private:
  void RecordChanges(const OccupancyDelta& delta);

  UpdateSequence<MapUpdate> sequence_;
  std::optional<OccupancyMap> occupancy_;
  int64_t utime_ = 0;
  OccupancyChanges changes_{true, {}};
  size_t changes_limit_ = 0;  // number of entries at which duplicates are removed
};

}  // namespace vismap
