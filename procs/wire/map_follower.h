#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "freespace/occupancy_map.h"
#include "wire/map_update.h"

namespace vismap {

/// A copy of a map's occupancy, kept equal to the server's by its updates. Knows when it has missed
/// one, and then needs a snapshot; until that has come completely, it goes on with the last
/// consistent state.
class MapFollower {
 public:
  enum class Outcome {
    kApplied,        ///< one update more
    kWaiting,        ///< a part of an update; more parts follow
    kIgnored,        ///< nothing new: an old update, or a snapshot of what is here already
    kNeedsSnapshot,  ///< an update is missing, or nothing is known yet
    kBroken,         ///< the update contradicts itself or the map; a snapshot is needed
  };

  Outcome Take(const MapUpdate& update);

  bool in_sync() const { return in_sync_; }
  const std::string& map_id() const { return map_id_; }
  int64_t revision() const { return revision_; }  ///< -1 before the first snapshot
  int64_t utime() const { return utime_; }        ///< of the newest frame contained [us]
  const std::optional<OccupancyMap>& occupancy() const {
    return occupancy_;
  }                                       ///< none before the first snapshot
  int64_t gaps() const { return gaps_; }  ///< how often updates were missing

 private:
  // A copy that the parts of one update are applied to, so that a half-received one is never seen.
  struct Staging {
    OccupancyMap occupancy;
    std::string map_id;
    int64_t revision;
    bool complete;
    int32_t next_part;
  };

  bool Begin(const MapUpdate& update);
  Outcome Missed();

  std::optional<OccupancyMap> occupancy_;
  std::string map_id_;
  int64_t revision_ = -1;
  int64_t utime_ = 0;
  int64_t gaps_ = 0;
  bool in_sync_ = false;
  std::optional<Staging> staging_;
};

}  // namespace vismap
