#include "wire/map_follower.h"

#include <algorithm>
#include <utility>

namespace vismap {
namespace {

void SortUnique(std::vector<BlockIndex>* blocks) {
  std::sort(blocks->begin(), blocks->end());
  blocks->erase(std::unique(blocks->begin(), blocks->end()), blocks->end());
}

}  // namespace

FollowOutcome MapFollower::Apply(MapUpdate update) {
  const bool complete = update.delta.complete;
  const double voxel_size = update.delta.voxel_size;
  const int64_t utime = update.utime;
  const UpdateHead head{update.map_id, update.revision, complete ? -1 : update.base_revision,
                        complete,      update.part,     update.parts};
  const FollowOutcome outcome = sequence_.AddPart(head, std::move(update));
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
