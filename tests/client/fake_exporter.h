#pragma once

#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>
#include <vismap/navigation_status_t.hpp>

#include "freespace/octree.h"
#include "navigation/distance_field.h"
#include "navigation/ground_grid.h"
#include "navigation/tree_leaves.h"
#include "process/process_harness.h"
#include "runtime/clock.h"
#include "wire/distance_update.h"
#include "wire/grid_message.h"
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

/// The grid of a band of heights.
inline occupancy_grid_t GridOf(const OccupancyMap& map, int64_t revision,
                               const std::string& map_id = "map a") {
  GroundGridOptions options;
  options.resolution_m = 0.1;
  options.band_min_m = 0.2;
  options.band_max_m = 1.0;
  const auto grid = MakeGroundGrid(map, options, {});
  if (!grid) throw std::runtime_error(grid.error().message);
  return Encode(GridMessage{5, WallUtime(), map_id, revision, options, *grid});
}

/// All distances in the leaves of a map, as an update from another revision; -1 = a complete one.
inline DistanceUpdate DistancesIn(const OccupancyMap& map, int64_t revision, int64_t base,
                                  const std::string& map_id = "map a") {
  const auto leaves =
      ReadTreeLeaves(TreeMessage(map, UnknownPolicy::kAbsent, revision).data, "the tree");
  if (!leaves) throw std::runtime_error(leaves.error().message);
  auto field = DistanceField::Make(leaves->cell_size(), {.limit_m = 1});
  if (!field) throw std::runtime_error(field.error().message);
  field->Update(*leaves, leaves->SortedIndices());
  DistanceUpdate update;
  update.head = {map_id, revision, base, base < 0, 0, 1};
  update.leaf_m = leaves->cell_size();
  update.limit_m = field->limit_m();
  for (const BlockIndex& index : field->SortedIndices())
    update.blocks.emplace_back(index, field->At(index));
  return update;
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
    if (grid) processes_->bus().Publish(kGridChannel, *grid);
    if (distances) {  // a heartbeat
      DistanceUpdate nothing = *distances;
      nothing.head.base_revision = nothing.head.revision;
      nothing.head.full = false;
      nothing.blocks.clear();
      processes_->bus().Publish(kDistancesChannel, Encode(nothing));
    }
  }
  void PublishDistances() { processes_->bus().Publish(kDistancesChannel, Encode(*distances)); }
  /// Answers distances-delta from now on: publishes all, or refuses with this sentence.
  void AnswerDistances(const std::string& refusal) {
    processes_->bus().Subscribe<map_request_t>(kMapRequestChannel,
                                               [this, refusal](const map_request_t& request) {
                                                 if (request.verb != "distances-delta") return;
                                                 asked.push_back(request.argument);
                                                 map_reply_t reply{};
                                                 reply.requester = request.source;
                                                 reply.request_id = request.request_id;
                                                 reply.ok = refusal.empty();
                                                 reply.message = refusal;
                                                 if (refusal.empty()) {
                                                   distances->head.full = true;
                                                   PublishDistances();
                                                 }
                                                 processes_->bus().Publish(kMapReplyChannel, reply);
                                               });
  }
  /// Adds an output to NAVIGATION, or changes its revision.
  void SetOutput(const std::string& channel, int64_t revision) {
    size_t i = 0;
    while (i < status.channels.size() && status.channels[i] != channel) ++i;
    if (i == status.channels.size()) {
      status.channels.push_back(channel);
      status.revisions.push_back(0);
      status.utimes.push_back(5);
      status.published_utimes.push_back(WallUtime());
      status.n_outputs = static_cast<int32_t>(status.channels.size());
    }
    status.revisions[i] = revision;
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
  std::optional<occupancy_grid_t> grid;
  std::optional<DistanceUpdate> distances;
  std::vector<std::string> asked;  // arguments of distances-delta
  bool server_lives = true;

 private:
  ProcessBus* processes_;
  double next_ = 0;
};

}  // namespace vismap::testing_support
