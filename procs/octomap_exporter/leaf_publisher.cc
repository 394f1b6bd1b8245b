#include "octomap_exporter/leaf_publisher.h"

#include <algorithm>
#include <utility>

#include "runtime/clock.h"

namespace vismap {

namespace {
constexpr size_t kBlocksPerDelta = 8192;  // at most a few hundred kilobytes compressed
}  // namespace

void LeafPublisher::PublishChanges(const FollowerPosition& position, int64_t utime,
                                   double voxel_size, OccupancyDelta leaves) {
  const int64_t base = leaves.complete ? -1 : position_.revision;
  if (leaves.complete) revisions_.Clear();
  for (const auto& entry : leaves.blocks) revisions_.FindOrCreate(entry.first) = position.revision;
  position_ = position;
  utime_ = utime;
  voxel_size_ = voxel_size;
  leaf_size_ = leaves.voxel_size;
  Publish(base, std::move(leaves));
}

void LeafPublisher::PublishSince(const FollowerPosition& position, const OccupancyMap& leaves) {
  if (position_.revision < 0) return;
  const bool known = position.map_id == position_.map_id && position.revision >= 0 &&
                     position.revision <= position_.revision;
  OccupancyDelta delta{leaf_size_, !known, {}};
  revisions_.ForEach([&](BlockIndex block, int64_t revision) {
    const bool counts =
        known ? revision > position.revision : !leaves.At(block).is(CellState::kUnknown);
    if (counts) delta.blocks.emplace_back(block, leaves.At(block));
  });
  std::sort(delta.blocks.begin(), delta.blocks.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  Publish(known ? position.revision : -1, std::move(delta));
}

void LeafPublisher::Heartbeat() {
  if (position_.revision < 0 || !heartbeat_pacer_.due()) return;
  Publish(position_.revision, {leaf_size_, false, {}});
}

void LeafPublisher::Clear() {
  position_ = {};
  revisions_.Clear();
}

void LeafPublisher::Publish(int64_t base_revision, OccupancyDelta leaves) {
  MapUpdate update{utime_, position_.map_id, position_.revision, base_revision, 0,
                   1,      std::move(leaves)};
  for (MapUpdate& part : SplitUpdate(std::move(update), kBlocksPerDelta))
    bus_->Publish(kOctomapDeltaChannel,
                  Encode(OctreeUpdate{std::move(part), WallUtime(), voxel_size_, shell_}));
  heartbeat_pacer_.Restart();
}

}  // namespace vismap
