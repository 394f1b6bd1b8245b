#pragma once

#include <cstdint>
#include <optional>

#include "freespace/occupancy_map.h"
#include "wire/map_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// A copy of a map's occupancy, kept equal to the server's by its updates. Knows when it has missed
/// one, and then asks for what it lacks; until that has come completely, it stays at the last
/// consistent state.
class MapFollower {
 public:
  FollowOutcome Take(const MapUpdate& update);

  bool in_sync() const { return sequence_.in_sync(); }
  const FollowerPosition& position() const { return sequence_.position(); }
  int64_t utime() const { return utime_; }  ///< of the newest frame contained [us]
  /// None before the first snapshot.
  const std::optional<OccupancyMap>& occupancy() const { return occupancy_; }
  int64_t gaps() const { return sequence_.gaps(); }  ///< how often updates were missing

 private:
  UpdateSequence<MapUpdate> sequence_;
  std::optional<OccupancyMap> occupancy_;
  int64_t utime_ = 0;
};

}  // namespace vismap
