#include "map_server/mesh_publisher.h"

#include <algorithm>
#include <utility>

#include "runtime/clock.h"
#include "wire/mesh_follower.h"
#include "wire/mesh_update.h"

namespace vismap {
namespace {

constexpr size_t kBlocksPerMesh = 256;  // a few megabytes
constexpr double kHeartbeat = 1.0;      // [s]

std::vector<BlockIndex> SortedUnique(std::vector<BlockIndex> blocks) {
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
}

}  // namespace

void MeshPublisher::Start(const SemanticMap& map, const std::string& map_id) {
  map_id_ = map_id;
  revision_ = -1;
  dirty_ = map.voxels.SortedIndices();
  shown_ = ShowLabels(map.labels);
  places_.Clear();
  places_.Note(map.voxels, dirty_);
  places_.MergeAll(map.labels);
  surfaces_.clear();
  log_.Clear();
}

void MeshPublisher::NoteChanges(const SemanticMap& map, const MapDelta& delta) {
  const std::vector<BlockIndex>& changed = delta.changed_blocks;
  places_.Note(map.voxels, changed);
  for (const auto& [dead, survivor] : delta.merged) places_.Merge(dead, survivor);
  dirty_.insert(dirty_.end(), changed.begin(), changed.end());
}

void MeshPublisher::AddBlocksShownOtherwise(const SemanticMap& map) {
  std::vector<ShownLabel> now = ShowLabels(map.labels);
  for (size_t i = 0; i < shown_.size(); ++i) {  // labels that are new came with changed blocks
    if (now[i] == shown_[i]) continue;
    const auto places = places_.Of(static_cast<SegmentLabel>(i));
    dirty_.insert(dirty_.end(), places.begin(), places.end());
  }
  shown_ = std::move(now);
}

void MeshPublisher::KeepWhatFollowersLack(std::vector<BlockMesh>* blocks) {
  std::erase_if(*blocks, [this](const BlockMesh& block) {
    if (block.mesh.vertices.empty()) return surfaces_.erase(block.block) == 0;
    surfaces_.insert(block.block);
    return false;
  });
}

void MeshPublisher::PublishChanges(const SemanticMap& map) {
  AddBlocksShownOtherwise(map);
  MeshDelta delta = MeshBlocks(map, SortedUnique(std::exchange(dirty_, {})), options_);
  KeepWhatFollowersLack(&delta.blocks);
  for (const BlockMesh& block : delta.blocks) log_.Record(map.revision, block.block);
  const int64_t base = std::exchange(revision_, map.revision);
  Publish(map, base, std::move(delta.blocks));  // the first of a map is all of it
}

void MeshPublisher::PublishAll(const SemanticMap& map) {
  dirty_.clear();
  shown_ = ShowLabels(map.labels);
  revision_ = map.revision;
  MeshDelta delta = MeshBlocks(map, map.voxels.SortedIndices(), options_);
  // Whoever has an older state of this map must hear of all surfaces again, and of their ends.
  for (const BlockIndex& block : surfaces_) log_.Record(map.revision, block);
  surfaces_.clear();
  KeepWhatFollowersLack(&delta.blocks);
  for (const BlockMesh& block : delta.blocks) log_.Record(map.revision, block.block);
  Publish(map, -1, std::move(delta.blocks));
}

void MeshPublisher::PublishSince(const SemanticMap& map, const FollowerPosition& position) {
  if (position.map_id != map_id_ || position.revision < 0 || position.revision > revision_)
    return PublishAll(map);
  PublishChanges(map);
  const auto changed = log_.Since(position.revision);
  if (!changed) return PublishAll(map);
  MeshDelta delta = MeshBlocks(map, *changed, options_);
  // Blocks around those that are asked for are made, too: the follower has them.
  std::erase_if(delta.blocks, [&](const BlockMesh& block) {
    return !std::binary_search(changed->begin(), changed->end(), block.block);
  });
  Publish(map, position.revision, std::move(delta.blocks));
}

void MeshPublisher::Heartbeat(const SemanticMap& map) {
  if (revision_ < 0 || has_changes() || MonotonicSeconds() - last_published_ < kHeartbeat) return;
  Publish(map, revision_, {});
}

void MeshPublisher::Publish(const SemanticMap& map, int64_t base_revision,
                            std::vector<BlockMesh> blocks) {
  MeshUpdate update{map.last_utime,
                    map_id_,
                    base_revision,
                    base_revision < 0,
                    0,
                    1,
                    map.voxels.block_size(),
                    {revision_, std::move(blocks)}};
  for (const MeshUpdate& part : SplitUpdate(std::move(update), kBlocksPerMesh))
    bus_->Publish(kMeshDeltaChannel, Encode(part));
  last_published_ = MonotonicSeconds();
}

std::string MeshPublisher::DigestOf(const SemanticMap& map, const MeshingOptions& options) {
  MeshUpdate update{0, "", -1, true, 0, 1, map.voxels.block_size(), {}};
  update.mesh = MeshBlocks(map, map.voxels.SortedIndices(), options);
  MeshDigest digest;
  for (const mesh_block_t& block : Encode(update).blocks) digest.Set(block);
  return digest.Hex();
}

}  // namespace vismap
