#include "map_server/occupancy_publisher.h"

#include <utility>

#include "wire/map_update.h"

namespace vismap {

namespace {
constexpr size_t kBlocksPerDelta = 8192;  // at most a few hundred kilobytes compressed
}  // namespace

void OccupancyPublisher::Start(const SemanticMap& map, const std::string& map_id) {
  cell_size_ = map.voxels.voxel_size();
  watch_.Clear();
  watch_.Update(map, map.voxels.SortedIndices());
  position_ = {map_id, map.revision};
  utime_ = map.last_utime;
}

void OccupancyPublisher::PublishChanges(const SemanticMap& map,
                                        std::span<const BlockIndex> changed) {
  OccupancyDelta delta = watch_.Update(map, changed);
  const int64_t base = std::exchange(position_.revision, map.revision);
  utime_ = map.last_utime;
  Publish(base, std::move(delta));
}

void OccupancyPublisher::PublishSnapshot(const SemanticMap& map) {
  OccupancyDelta delta = ClassifyBlocks(map, map.voxels.SortedIndices(), options_);
  delta.complete = true;
  std::erase_if(delta.blocks,
                [](const auto& block) { return block.second.is(CellState::kUnknown); });
  Publish(-1, std::move(delta));
}

void OccupancyPublisher::PublishSince(const SemanticMap& map, const FollowerPosition& position) {
  if (position.map_id != position_.map_id || position.revision < 0 ||
      position.revision > position_.revision) {
    return PublishSnapshot(map);
  }
  Publish(position.revision, ClassifyBlocks(map, watch_.ChangedAfter(position.revision), options_));
}

void OccupancyPublisher::Heartbeat() {
  if (!heartbeat_pacer_.due()) return;
  Publish(position_.revision, {cell_size_, false, {}});
}

void OccupancyPublisher::Publish(int64_t base_revision, OccupancyDelta delta) {
  MapUpdate update{utime_, position_.map_id, position_.revision, base_revision, 0,
                   1,      std::move(delta)};
  for (const MapUpdate& part : SplitUpdate(std::move(update), kBlocksPerDelta))
    bus_->Publish(kMapDeltaChannel, Encode(part));
  heartbeat_pacer_.Restart();
}

}  // namespace vismap
