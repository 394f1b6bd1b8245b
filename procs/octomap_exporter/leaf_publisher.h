#pragma once

#include "map/block_table.h"
#include "runtime/bus.h"
#include "runtime/pacer.h"
#include "wire/octree_update.h"
#include "wire/update_sequence.h"

namespace vismap {

/// Publishes the leaves of the octree that change on OCTOMAP_DELTA, so that followers which may
/// miss messages can always end with exactly the tree on OCTOMAP.
class LeafPublisher {
 public:
  /// `shell`: of the closed tree [m]. `bus` must outlive it.
  LeafPublisher(double shell, Bus* bus) : shell_(shell), bus_(bus) {}

  /// The leaves that changed up to a position; all of them when the delta is complete.
  void PublishChanges(const FollowerPosition& position, int64_t utime, double voxel_size,
                      OccupancyDelta leaves);
  /// What a follower at `position` lacks: the blocks that changed since, or everything. `leaves`:
  /// as at the last PublishChanges.
  void PublishSince(const FollowerPosition& position, const OccupancyMap& leaves);
  /// The present revision without a change, when nothing else was said for a second: from it a
  /// follower learns that it missed the last update. Nothing before the first PublishChanges.
  void Heartbeat();
  /// The map is gone; nothing is published until the next complete delta.
  void Clear();

 private:
  void Publish(int64_t base_revision, OccupancyDelta leaves);

  double shell_;
  Bus* bus_;
  FollowerPosition position_;  // that followers reach by what was published
  int64_t utime_ = 0;
  double voxel_size_ = 0, leaf_size_ = 0;  // [m]
  BlockTable<int64_t> revisions_;          // of the last change of each block
  Pacer heartbeat_pacer_{1.0};
};

}  // namespace vismap
