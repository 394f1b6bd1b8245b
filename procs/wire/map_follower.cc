#include "wire/map_follower.h"

#include <algorithm>
#include <utility>

namespace vismap {
namespace {

void SortUnique(std::vector<BlockIndex>* blocks) {
  std::sort(blocks->begin(), blocks->end());
  blocks->erase(std::unique(blocks->begin(), blocks->end()), blocks->end());
}

size_t BytesOf(const MapUpdate& update) {
  size_t bytes = update.map_id.size();
  for (const auto& entry : update.delta.blocks)
    bytes += sizeof(entry) + (entry.second.is_uniform() ? 0 : OccupancyMap::kMixedBytes);
  return bytes;
}

}  // namespace

FollowOutcome MapFollower::Apply(MapUpdate update, double now) {
  const bool complete = update.delta.complete;
  const double voxel_size = update.delta.voxel_size;
  const int64_t utime = update.utime;
  const UpdateHead head{update.map_id, update.revision, complete ? -1 : update.base_revision,
                        complete,      update.part,     update.parts};
  const size_t bytes = BytesOf(update);
  const FollowOutcome outcome = sequence_.AddPart(head, std::move(update), bytes, now);
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (complete) {
    occupancy_.emplace(voxel_size);
    changes_ = {true, {}};
  }
  for (MapUpdate& part : sequence_.ReleaseParts()) {
    part.delta.complete = false;
    RecordChanges(part.delta);
    if (!occupancy_->Apply(part.delta)) {
      sequence_.RequireSnapshot();
      return FollowOutcome::kBroken;
    }
    if (occupancy_->bytes() > sequence_.limits().max_bytes) {
      occupancy_.reset();
      changes_ = {true, {}};
      sequence_.RequireSnapshot();
      return FollowOutcome::kTooLarge;
    }
  }
  utime_ = utime;
  return outcome;
}

void MapFollower::RecordChanges(const OccupancyDelta& delta) {
  if (changes_.everywhere) return;
  for (const auto& entry : delta.blocks) changes_.blocks.push_back(entry.first);
  if (changes_.blocks.size() <= changes_limit_) return;
  // A camera that does not move changes the same blocks in every update.
  SortUnique(&changes_.blocks);
  changes_limit_ = std::max<size_t>(65536, 2 * changes_.blocks.size());
  // More changed blocks than the map has: many of them were created and deleted. The list would
  // only grow.
  if (changes_.blocks.size() > occupancy_->size() + 65536) changes_ = {true, {}};
}

OccupancyChanges MapFollower::ConsumeChanges() {
  SortUnique(&changes_.blocks);
  changes_limit_ = 0;
  return std::exchange(changes_, {!occupancy_, {}});
}

}  // namespace vismap
