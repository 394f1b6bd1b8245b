#pragma once

#include <optional>

#include "freespace/octree_cache.h"
#include "wire/map_follower.h"
#include "wire/octree_update.h"

namespace vismap {

/// A copy of the leaves of the exporter's tree, built from its OCTOMAP_DELTA updates, for readers
/// of large maps. It detects a missing update and then reports kNeedsSnapshot: ask for it with the
/// verb octomap-delta. Memory is bounded as that of a MapFollower.
class OctreeFollower {
 public:
  explicit OctreeFollower(const FollowLimits& limits = {}) : follower_(limits) {}

  /// Adds one part of an update at time `now` [s]; the copy changes when the last part has arrived.
  FollowOutcome Apply(OctreeUpdate update, double now = 0);

  /// The tree at position(): the same bytes as on OCTOMAP (kOccupied) or OCTOMAP_RAW (kAbsent).
  /// Only what changed since the last call is written again. Fails while nothing is known, and as
  /// OctreeCache does.
  Result<OctreeBytes> Build(UnknownPolicy unknown);

  /// Drops the parts of an update whose other parts do not come. Returns how many.
  size_t GiveUpStaleParts(double now) { return follower_.GiveUpStaleParts(now); }
  bool in_sync() const { return follower_.in_sync(); }
  const FollowerPosition& position() const { return follower_.position(); }
  int64_t utime() const { return follower_.utime(); }  ///< of the newest frame contained [us]
  int64_t gaps() const { return follower_.gaps(); }    ///< how often an update was missing
  /// The leaves; nullopt before the first update.
  const std::optional<OccupancyMap>& leaves() const { return follower_.occupancy(); }

 private:
  MapFollower follower_;
  OctreeCache cache_;
  double shell_ = 0;  // [m]
};

}  // namespace vismap
