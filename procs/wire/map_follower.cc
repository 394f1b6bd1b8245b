#include "wire/map_follower.h"

namespace vismap {

FollowOutcome MapFollower::Take(const MapUpdate& update) {
  const bool complete = update.delta.complete;
  const FollowOutcome outcome =
      sequence_.Take({update.map_id, update.revision, complete ? -1 : update.base_revision,
                      complete, update.part, update.parts},
                     update);
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (complete) occupancy_.emplace(update.delta.voxel_size);
  for (const MapUpdate& part : sequence_.ready()) {
    OccupancyDelta delta = part.delta;
    delta.complete = false;
    if (!occupancy_->Apply(delta)) {
      sequence_.Distrust();
      return FollowOutcome::kBroken;
    }
  }
  utime_ = update.utime;
  return outcome;
}

}  // namespace vismap
