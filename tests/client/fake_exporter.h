#pragma once

#include <stdexcept>
#include <string>
#include <vismap/navigation_status_t.hpp>

#include "freespace/octree.h"
#include "process/process_harness.h"
#include "runtime/clock.h"
#include "wire/octree_message.h"

namespace vismap::testing_support {

/// Two rooms of 1.6 x 1.6 x 1.6 m, free but for a pillar in the first one, 0.4 m of space between
/// them that is free or unknown. All else is unknown. Voxels of 5 cm, leaves of 10 cm.
inline OccupancyMap TwoRooms(bool open) {
  OccupancyMap map(0.05);
  for (int x = 0; x < 9; ++x) {
    for (int y = 0; y < 4; ++y) {
      for (int z = 0; z < 4; ++z) {
        if (x != 4 || open) map.Set({x, y, z}, BlockOccupancy(CellState::kFree));
      }
    }
  }
  for (int z = 0; z < 4; ++z) map.Set({2, 2, z}, BlockOccupancy(CellState::kOccupied));
  return map;
}

inline octree_t TreeMessage(const OccupancyMap& map, UnknownPolicy unknown, int64_t revision,
                            const std::string& map_id = "map a") {
  OctreeOptions options;
  options.resolution_m = 0.1;
  options.unknown = unknown;
  const auto tree = BuildOctree(map, options);
  if (!tree) throw std::runtime_error(tree.error().message);
  OctreeMessage message;
  message.utime = 5;
  message.published_utime = WallUtime();
  message.map_id = map_id;
  message.revision = revision;
  message.voxel_size = map.cell_size();
  message.octree = *tree;
  return Encode(message);
}

/// Publishes what the octomap exporter does, as the test wants it.
class FakeExporter {
 public:
  explicit FakeExporter(ProcessBus* processes) : processes_(processes) {
    status.map_id = "map a";
    status.in_sync = true;
  }

  void SetMap(const OccupancyMap& map, int64_t revision) {
    closed = TreeMessage(map, UnknownPolicy::kOccupied, revision, status.map_id);
    raw = TreeMessage(map, UnknownPolicy::kAbsent, revision, status.map_id);
    status.revision = revision;
    status.channels = {"OCTOMAP", "OCTOMAP_RAW"};
    status.revisions = {revision, revision};
    status.utimes = {5, 5};
    status.published_utimes = {WallUtime(), WallUtime()};
    status.n_outputs = 2;
    PublishTrees();
  }
  void PublishTrees() {
    processes_->bus().Publish(kOctomapChannel, closed);
    processes_->bus().Publish(kOctomapRawChannel, raw);
  }
  void PublishStatus() {
    status.published_utime = WallUtime();
    if (server_lives) status.server_utime = status.published_utime;
    processes_->bus().Publish(kNavigationChannel, status);
  }

  /// Is alive until `condition` holds: trees and status come every 0.25 s.
  template <typename Condition>
  bool LiveUntil(const Condition& condition) {
    return processes_->SpinUntil([&] {
      if (MonotonicSeconds() >= next_) {
        next_ = MonotonicSeconds() + 0.25;
        PublishTrees();
        PublishStatus();
      }
      return condition();
    });
  }

  navigation_status_t status{};
  octree_t closed{}, raw{};
  bool server_lives = true;

 private:
  ProcessBus* processes_;
  double next_ = 0;
};

}  // namespace vismap::testing_support
