#include "map_server/occupancy_publisher.h"

#include <utility>

#include "runtime/clock.h"
#include "wire/map_update.h"

namespace vismap {

namespace {
constexpr size_t kBlocksPerDelta = 8192;  // at most a few hundred kilobytes compressed
constexpr double kHeartbeat = 1.0;        // [s]
}  // namespace

void OccupancyPublisher::Start(const SemanticMap& map, const std::string& map_id) {
  occupancy_ = OccupancyMap(map.voxels.voxel_size());
  occupancy_.Update(map, map.voxels.SortedIndices(), options_);
  log_.Clear();
  position_ = {map_id, map.revision};
  utime_ = map.last_utime;
}

void OccupancyPublisher::PublishChanges(const SemanticMap& map,
                                        std::span<const BlockIndex> changed) {
  OccupancyDelta delta = occupancy_.Update(map, changed, options_);
  for (const auto& entry : delta.blocks) log_.Record(map.revision, entry.first);
  const int64_t base = std::exchange(position_.revision, map.revision);
  utime_ = map.last_utime;
  Publish(base, std::move(delta));
}

void OccupancyPublisher::PublishSnapshot() { Publish(-1, occupancy_.Snapshot()); }

void OccupancyPublisher::PublishSince(const FollowerPosition& position) {
  if (position.map_id != position_.map_id || position.revision < 0 ||
      position.revision > position_.revision) {
    return PublishSnapshot();
  }
  const auto changed = log_.Since(position.revision);
  if (!changed) return PublishSnapshot();
  OccupancyDelta delta{occupancy_.cell_size(), false, {}};
  for (const BlockIndex& block : *changed) delta.blocks.emplace_back(block, occupancy_.At(block));
  Publish(position.revision, std::move(delta));
}

void OccupancyPublisher::Heartbeat() {
  if (MonotonicSeconds() - last_published_ < kHeartbeat) return;
  Publish(position_.revision, {occupancy_.cell_size(), false, {}});
}

void OccupancyPublisher::Publish(int64_t base_revision, OccupancyDelta delta) {
  MapUpdate update{utime_, position_.map_id, position_.revision, base_revision, 0,
                   1,      std::move(delta)};
  for (const MapUpdate& part : SplitUpdate(std::move(update), kBlocksPerDelta))
    bus_->Publish(kMapDeltaChannel, Encode(part));
  last_published_ = MonotonicSeconds();
}

}  // namespace vismap
