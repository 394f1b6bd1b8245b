#include "wire/octree_follower.h"

#include <utility>

namespace vismap {

FollowOutcome OctreeFollower::Apply(OctreeUpdate update, double now) {
  const FollowOutcome outcome = follower_.Apply(std::move(update.leaves), now);
  if (outcome == FollowOutcome::kApplied) shell_ = update.shell;
  return outcome;
}

Result<OctreeBytes> OctreeFollower::Build(UnknownPolicy unknown) {
  if (!leaves()) return Fail("no octree yet: nothing has come on OCTOMAP_DELTA");
  if (leaves()->size() == 0) return Fail("no octree: nothing is known yet");
  const OccupancyChanges changes = follower_.ConsumeChanges();
  if (changes.everywhere) cache_ = {};
  cache_.Update(*leaves(), changes.everywhere ? leaves()->SortedIndices() : changes.blocks);
  return cache_.Encode(
      *leaves(), {.resolution_m = leaves()->cell_size(), .unknown = unknown, .shell_m = shell_});
}

}  // namespace vismap
