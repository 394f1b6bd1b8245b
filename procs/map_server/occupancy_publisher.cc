#include "map_server/occupancy_publisher.h"

#include <utility>

#include "wire/map_update.h"

namespace vismap {

namespace {
constexpr size_t kBlocksPerDelta = 8192;  // at most a few hundred kilobytes compressed

std::vector<map_delta_t> Encoded(MapUpdate update) {
  std::vector<map_delta_t> messages;
  for (const MapUpdate& part : SplitUpdate(std::move(update), kBlocksPerDelta))
    messages.push_back(Encode(part));
  return messages;
}

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

void OccupancyPublisher::PublishSince(const SemanticMap& map, const FollowerPosition& position) {
  Send(MessagesFor(GapSince(position), map, options_));
}

void OccupancyPublisher::PublishNewer(const SemanticMap& map, const FollowerPosition& position) {
  if (position.map_id == position_.map_id && position.revision < position_.revision)
    PublishSince(map, position);
}

OccupancyGap OccupancyPublisher::GapSince(const FollowerPosition& position) const {
  OccupancyGap gap{position_, utime_, -1, {}};
  const bool known = position.map_id == position_.map_id && position.revision >= 0 &&
                     position.revision <= position_.revision;
  if (!known) return gap;
  gap.base_revision = position.revision;
  gap.blocks = watch_.ChangedAfter(position.revision);
  return gap;
}

std::vector<map_delta_t> OccupancyPublisher::MessagesFor(const OccupancyGap& gap,
                                                         const SemanticMap& map,
                                                         const OccupancyOptions& options) {
  const bool everything = gap.base_revision < 0;
  OccupancyDelta delta =
      ClassifyBlocks(map, everything ? map.voxels.SortedIndices() : gap.blocks, options);
  delta.complete = everything;
  if (everything) {
    std::erase_if(delta.blocks,
                  [](const auto& block) { return block.second.is(CellState::kUnknown); });
  }
  return Encoded({gap.utime, gap.position.map_id, gap.position.revision, gap.base_revision, 0, 1,
                  std::move(delta)});
}

void OccupancyPublisher::Send(std::vector<map_delta_t> messages) {
  for (map_delta_t& message : messages) {
    if (message.map_id == position_.map_id) bus_->Publish(kMapDeltaChannel, std::move(message));
  }
  heartbeat_pacer_.Restart();
}

void OccupancyPublisher::Heartbeat() {
  if (!heartbeat_pacer_.due()) return;
  Publish(position_.revision, {cell_size_, false, {}});
}

void OccupancyPublisher::Publish(int64_t base_revision, OccupancyDelta delta) {
  Send(Encoded(
      {utime_, position_.map_id, position_.revision, base_revision, 0, 1, std::move(delta)}));
}

}  // namespace vismap
