#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "freespace/occupancy_map.h"
#include "wire/map_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Where a map's occupancy may differ from what it was at an earlier time.
struct OccupancyChanges {
  bool everywhere = false;         ///< also where there is nothing any more
  std::vector<BlockIndex> blocks;  ///< ascending; empty when everywhere
};

/// A copy of a map's occupancy, kept equal to the server's by its updates. Knows when it has missed
/// one, and then asks for what it lacks; until that has come completely, it stays at the last
/// consistent state.
class MapFollower {
 public:
  FollowOutcome Apply(MapUpdate update);

  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }  ///< of the newest frame contained [us]
  /// None before the first snapshot.
  const std::optional<OccupancyMap>& occupancy() const { return occupancy_; }
  int64_t gaps() const { return sequence_.gaps(); }  ///< how often updates were missing

  /// What became different since the last call; at first, and after a snapshot, everywhere.
  OccupancyChanges ConsumeChanges();

 private:
  void RecordChanges(const OccupancyDelta& delta);

  UpdateSequence<MapUpdate> sequence_;
  std::optional<OccupancyMap> occupancy_;
  int64_t utime_ = 0;
  OccupancyChanges changes_{true, {}};
  size_t changes_limit_ = 0;  // at which repetitions are dropped
};

}  // namespace vismap
