#include "octomap_exporter/distance_publisher.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

#include "runtime/clock.h"
#include "wire/channels.h"

namespace vismap {

namespace {
constexpr size_t kBlocksPerMessage = 2048;  // 4 MB before compression
}  // namespace

Result<void> DistancePublisher::Update(const FollowerPosition& position, int64_t utime,
                                       const OccupancyMap& leaves,
                                       std::span<const BlockIndex> changed) {
  if (limit_m_ <= 0) return {};
  const bool anew = !field_;
  if (anew) {
    Result<DistanceField> made = DistanceField::Make(leaves.cell_size(), {limit_m_});
    if (!made) return tl::unexpected(made.error());
    field_.emplace(std::move(*made));
  }
  std::vector<BlockIndex> affected = field_->Update(leaves, changed);
  std::vector<BlockIndex> sorted(changed.begin(), changed.end()), all;
  std::sort(sorted.begin(), sorted.end());
  std::set_union(affected.begin(), affected.end(), sorted.begin(), sorted.end(),
                 std::back_inserter(all));
  for (const BlockIndex& index : all) revisions_.FindOrCreate(index) = position.revision;
  const int64_t base = anew ? -1 : position_.revision;
  position_ = position;
  utime_ = utime;
  Publish(base, anew ? field_->SortedIndices() : all);
  return {};
}

Result<void> DistancePublisher::PublishSince(const FollowerPosition& position) {
  if (limit_m_ <= 0) {
    return Fail(
        "distances are not kept up to date; set octomap_exporter.distance_limit_m, or ask "
        "for distances or clearance");
  }
  if (!field_) return Fail("no distances yet: nothing has come on MAP_DELTA");
  const bool known = position.map_id == position_.map_id && position.revision >= 0 &&
                     position.revision <= position_.revision;
  std::vector<BlockIndex> blocks;
  if (known) {
    revisions_.ForEach([&](BlockIndex block, int64_t revision) {
      if (revision > position.revision) blocks.push_back(block);
    });
    std::sort(blocks.begin(), blocks.end());
  } else {
    blocks = field_->SortedIndices();
  }
  Publish(known ? position.revision : -1, blocks);
  return {};
}

void DistancePublisher::Heartbeat() {
  if (field_ && heartbeat_pacer_.due()) Publish(position_.revision, {});
}

void DistancePublisher::Clear() {
  field_.reset();
  position_ = {};
  revisions_.Clear();
}

void DistancePublisher::Publish(int64_t base_revision, std::span<const BlockIndex> blocks) {
  const size_t parts =
      std::max<size_t>(1, (blocks.size() + kBlocksPerMessage - 1) / kBlocksPerMessage);
  for (size_t part = 0; part < parts; ++part) {
    DistanceUpdate update;
    update.head = {position_.map_id,  position_.revision,         base_revision,
                   base_revision < 0, static_cast<int32_t>(part), static_cast<int32_t>(parts)};
    update.utime = utime_;
    update.published_utime = published_utime_ = WallUtime();
    update.leaf_m = field_->leaf_m();
    update.limit_m = field_->limit_m();
    const size_t from = part * kBlocksPerMessage;
    const size_t count = std::min(kBlocksPerMessage, blocks.size() - from);
    for (const BlockIndex& index : blocks.subspan(from, count))
      update.blocks.emplace_back(index, field_->At(index));
    bus_->Publish(kDistancesChannel, Encode(update));
  }
  heartbeat_pacer_.Restart();
}

}  // namespace vismap
