#pragma once

#include <span>
#include <string>

#include "freespace/occupancy_map.h"
#include "map_server/change_log.h"
#include "runtime/bus.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Publishes a map's free and occupied space on MAP_DELTA, so that followers which may miss
/// messages can always end with exactly its state.
class OccupancyPublisher {
 public:
  OccupancyPublisher(const OccupancyOptions& options, double voxel_size, Bus* bus)
      : options_(options), bus_(bus), occupancy_(voxel_size) {}

  /// From now on of this map; publishes nothing.
  void Start(const SemanticMap& map, const std::string& map_id);
  /// One frame changed these blocks.
  void PublishChanges(const SemanticMap& map, std::span<const BlockIndex> changed);
  /// Everything.
  void PublishSnapshot();
  /// What a follower at this position lacks: the blocks that changed since, or everything.
  void PublishSince(const FollowerPosition& position);
  /// The present revision without a change, when nothing else was said for a second: from it a
  /// follower learns that it missed the last update.
  void Heartbeat();

  const OccupancyMap& occupancy() const { return occupancy_; }

 private:
  void Publish(int64_t base_revision, OccupancyDelta delta);

  OccupancyOptions options_;
  Bus* bus_;
  OccupancyMap occupancy_;
  ChangeLog log_;
  FollowerPosition position_;  // that followers reach by what was published
  int64_t utime_ = 0;
  double last_published_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
