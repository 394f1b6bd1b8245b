#include "wire/distance_follower.h"

#include <algorithm>
#include <utility>

namespace vismap {

FollowOutcome DistanceFollower::Apply(DistanceUpdate update, double now) {
  const bool other_field = update.leaf_m != leaf_m_ || update.limit_m != limit_m_;
  if (!update.head.full && in_sync() && other_field) {
    sequence_.RequireSnapshot();
    return FollowOutcome::kBroken;
  }
  const UpdateHead head = update.head;
  const double leaf_m = update.leaf_m, limit_m = update.limit_m;
  const int64_t utime = update.utime;
  const size_t bytes = update.blocks.size() * sizeof(DistanceBlocks::value_type);
  const FollowOutcome outcome = sequence_.AddPart(head, std::move(update), bytes, now);
  if (outcome != FollowOutcome::kApplied) return outcome;
  if (head.full) blocks_.Clear();
  for (DistanceUpdate& part : sequence_.ReleaseParts()) ApplyPart(std::move(part));
  leaf_m_ = leaf_m;
  limit_m_ = limit_m;
  utime_ = utime;
  const size_t used = blocks_.bytes() + blocks_.size() * (sizeof(BlockDistances) + 32);
  if (used <= sequence_.limits().max_bytes) return outcome;
  blocks_.Clear();
  sequence_.RequireSnapshot();
  return FollowOutcome::kTooLarge;
}

void DistanceFollower::ApplyPart(DistanceUpdate part) {
  for (auto& [index, distances] : part.blocks) {
    if (distances) {
      blocks_.FindOrCreate(index) = std::make_shared<const BlockDistances>(*distances);
    } else {
      blocks_.Erase(index);
    }
  }
}

std::optional<BlockDistances> DistanceFollower::At(BlockIndex index) const {
  const auto* found = blocks_.Find(index);
  return found == nullptr ? std::nullopt : std::optional(**found);
}

SharedDistanceBlocks DistanceFollower::Share() const {
  SharedDistanceBlocks blocks;
  blocks.reserve(blocks_.size());
  blocks_.ForEach(
      [&](BlockIndex index, const auto& distances) { blocks.emplace_back(index, distances); });
  std::sort(blocks.begin(), blocks.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  return blocks;
}

}  // namespace vismap
