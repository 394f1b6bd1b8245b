#include "wire/map_follower.h"

namespace vismap {

MapFollower::Outcome MapFollower::Missed() {
  if (in_sync_) ++gaps_;
  in_sync_ = false;
  staging_.reset();
  return Outcome::kNeedsSnapshot;
}

// Whether the first part of an update goes on from what is here.
bool MapFollower::Begin(const MapUpdate& update) {
  const bool complete = update.delta.complete;
  if (update.part != 0) return false;
  if (!complete && (!occupancy_ || update.map_id != map_id_ || update.base_revision != revision_))
    return false;
  staging_ = Staging{complete ? OccupancyMap(update.delta.voxel_size) : *occupancy_, update.map_id,
                     update.revision, complete, 0};
  return true;
}

MapFollower::Outcome MapFollower::Take(const MapUpdate& update) {
  const bool same_map = update.map_id == map_id_;
  if (same_map && in_sync_ && update.revision <= revision_) return Outcome::kIgnored;

  // The common case, without a copy: a one-part update of what is here.
  if (!update.delta.complete && update.parts == 1 && same_map && in_sync_ &&
      update.base_revision == revision_) {
    if (!occupancy_->Apply(update.delta)) return Missed(), Outcome::kBroken;
    revision_ = update.revision;
    utime_ = update.utime;
    return Outcome::kApplied;
  }
  const bool continues =
      staging_ && staging_->map_id == update.map_id && staging_->revision == update.revision &&
      staging_->complete == update.delta.complete && staging_->next_part == update.part;
  if (!continues && (!Begin(update) || (!update.delta.complete && !in_sync_))) return Missed();

  OccupancyDelta part = update.delta;
  part.complete = false;
  if (!staging_->occupancy.Apply(part)) return Missed(), Outcome::kBroken;
  if (++staging_->next_part < update.parts) return Outcome::kWaiting;

  occupancy_ = std::move(staging_->occupancy);
  map_id_ = update.map_id;
  revision_ = update.revision;
  utime_ = update.utime;
  in_sync_ = true;
  staging_.reset();
  return Outcome::kApplied;
}

}  // namespace vismap
