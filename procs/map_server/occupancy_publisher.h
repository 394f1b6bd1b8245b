#pragma once

#include <span>
#include <string>
#include <vector>
#include <vismap/map_delta_t.hpp>

#include "freespace/occupancy_watch.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "wire/update_sequence.h"

namespace vismap {

/// The blocks that a follower lacks.
struct OccupancyGap {
  FollowerPosition position;  ///< that it has after the update
  int64_t utime = 0;          ///< of the newest frame in it [us]
  int64_t base_revision = -1;
  std::vector<BlockIndex> blocks;  ///< not used when base_revision is -1: all of the map
};

/// Publishes a map's free and occupied space on MAP_DELTA, so that followers which may miss
/// messages can always end with exactly its state.
class OccupancyPublisher {
 public:
  OccupancyPublisher(const OccupancyOptions& options, Bus* bus)
      : options_(options), bus_(bus), watch_(options) {}

  /// From now on of this map; publishes nothing.
  void Start(const SemanticMap& map, const std::string& map_id);
  /// One frame changed these blocks.
  void PublishChanges(const SemanticMap& map, std::span<const BlockIndex> changed);
  /// Everything.
  void PublishSnapshot(const SemanticMap& map) { PublishSince(map, {}); }
  /// What a follower at this position lacks: the blocks that changed since, or everything.
  void PublishSince(const SemanticMap& map, const FollowerPosition& position);
  /// The same for a follower that has just got `position`, unless it is the newest one or that of
  /// another map: frames may have been published since its messages were made.
  void PublishNewer(const SemanticMap& map, const FollowerPosition& position);
  /// PublishSince in two steps, so that the second one can be done by another thread with a copy of
  /// the map. The messages are for Send.
  OccupancyGap GapSince(const FollowerPosition& position) const;
  static std::vector<map_delta_t> MessagesFor(const OccupancyGap& gap, const SemanticMap& map,
                                              const OccupancyOptions& options);
  /// Publishes messages unless the map has been replaced since.
  void Send(std::vector<map_delta_t> messages);
  /// The present revision without a change, when nothing else was said for a second: from it a
  /// follower learns that it missed the last update.
  void Heartbeat();

  /// What followers have that missed nothing.
  std::string Digest() const { return watch_.Digest(cell_size_); }
  size_t blocks() const { return watch_.size(); }  ///< of which anything is known
  size_t bytes() const { return watch_.bytes(); }  ///< memory, about

 private:
  void Publish(int64_t base_revision, OccupancyDelta delta);

  OccupancyOptions options_;
  Bus* bus_;
  OccupancyWatch watch_;
  double cell_size_ = 0;       // [m]
  FollowerPosition position_;  // that followers reach by what was published
  int64_t utime_ = 0;
  Pacer heartbeat_pacer_{1.0};
};

}  // namespace vismap
