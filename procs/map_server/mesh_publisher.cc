#include "map_server/mesh_publisher.h"

#include <algorithm>
#include <utility>

#include "runtime/clock.h"
#include "wire/mesh_follower.h"
#include "wire/mesh_update.h"

namespace vismap {
namespace {

constexpr size_t kBlocksPerPart = 512;  // a few megabytes of mesh at a time
constexpr double kHeartbeat = 1.0;      // [s]

std::vector<BlockIndex> BlocksNearSurfaces(const VoxelMap& map) {
  std::vector<BlockIndex> blocks;
  map.blocks().ForEach([&](BlockIndex index, const Block& block) {
    if (block.surface) blocks.push_back(index);
  });
  return BlocksToMesh(map, blocks);
}

// Some blocks at a time, so that little mesh is in memory; at least once. `take(part, parts, mesh)`
template <typename Take>
void MeshInParts(const SemanticMap& map, std::span<const BlockIndex> blocks,
                 std::span<const ShownLabel> shown, const MeshingOptions& options,
                 const Take& take) {
  const size_t parts = std::max<size_t>(1, (blocks.size() + kBlocksPerPart - 1) / kBlocksPerPart);
  for (size_t part = 0; part < parts; ++part) {
    const auto some = blocks.subspan(part * kBlocksPerPart);
    take(part, parts,
         MeshEachBlock(map, some.first(std::min(some.size(), kBlocksPerPart)), shown, options));
  }
}

}  // namespace

void MeshPublisher::Start(const SemanticMap& map, const std::string& map_id) {
  const std::vector<BlockIndex> all = map.voxels.SortedIndices();
  map_id_ = map_id;
  revision_ = -1;
  dirty_.clear();
  NoteDirty(all);
  shown_ = ShowLabels(map.labels);
  places_.Clear();
  places_.Note(map.voxels, all);
  places_.MergeAll(map.labels);
  surfaces_.Clear();
  log_.Clear();
}

void MeshPublisher::NoteChanges(const SemanticMap& map, const MapDelta& delta) {
  places_.Note(map.voxels, delta.changed_blocks);
  for (const auto& [dead, survivor] : delta.merged) places_.Merge(dead, survivor);
  NoteDirty(delta.changes());
}

void MeshPublisher::NoteDirty(const BlockChanges& changes) {
  for (size_t i = 0; i < changes.blocks.size(); ++i) {
    dirty_.push_back(
        {changes.blocks[i], changes.affected.empty() ? kAllNeighbours : changes.affected[i]});
  }
}

std::vector<BlockIndex> MeshPublisher::TakeBlocksToMesh(const VoxelMap& map) {
  std::sort(dirty_.begin(), dirty_.end(),
            [](const Dirty& a, const Dirty& b) { return a.block < b.block; });
  std::vector<BlockIndex> blocks;
  std::vector<NeighbourBits> affected;
  for (const Dirty& dirty : dirty_) {
    if (blocks.empty() || blocks.back() != dirty.block) {
      blocks.push_back(dirty.block);
      affected.push_back(0);
    }
    affected.back() |= dirty.affected;
  }
  dirty_.clear();
  return BlocksToMesh(map, {blocks, affected});
}

void MeshPublisher::AddBlocksShownOtherwise(const SemanticMap& map) {
  std::vector<ShownLabel> now = ShowLabels(map.labels);
  for (size_t i = 0; i < shown_.size(); ++i) {  // labels that are new came with changed blocks
    if (now[i] == shown_[i]) continue;
    NoteDirty(places_.Of(static_cast<SegmentLabel>(i)));
  }
  shown_ = std::move(now);
}

// Whether followers have another surface there, which they must hear of.
bool MeshPublisher::NoteSurface(const SemanticMap& map, const BlockMesh& block) {
  if (!surfaces_.Update(block, map.voxels.voxel_size())) return false;
  log_.Record(map.revision, block.block);
  return true;
}

void MeshPublisher::PublishChanges(const SemanticMap& map) {
  AddBlocksShownOtherwise(map);
  const std::vector<BlockIndex> blocks = TakeBlocksToMesh(map.voxels);
  const int64_t base = std::exchange(revision_, map.revision);
  Publish(map, base, blocks,  // the first of a map is all of it
          [&](const BlockMesh& block) { return NoteSurface(map, block); });
}

void MeshPublisher::PublishAll(const SemanticMap& map) {
  dirty_.clear();
  shown_ = ShowLabels(map.labels);
  revision_ = map.revision;
  // Whoever has an older state of this map must hear of all surfaces again, and of their ends.
  for (const BlockIndex& block : surfaces_.Blocks()) log_.Record(map.revision, block);
  surfaces_.Clear();
  Publish(map, -1, BlocksNearSurfaces(map.voxels),
          [&](const BlockMesh& block) { return NoteSurface(map, block); });
}

void MeshPublisher::PublishSince(const SemanticMap& map, const FollowerPosition& position) {
  if (position.map_id != map_id_ || position.revision < 0 || position.revision > revision_)
    return PublishAll(map);
  PublishChanges(map);
  const auto changed = log_.Since(position.revision);
  if (!changed) return PublishAll(map);
  Publish(map, position.revision, *changed, [](const BlockMesh&) { return true; });
}

void MeshPublisher::Heartbeat(const SemanticMap& map) {
  if (revision_ < 0 || has_changes() || MonotonicSeconds() - last_published_ < kHeartbeat) return;
  Publish(map, revision_, {}, {});
}

void MeshPublisher::Publish(const SemanticMap& map, int64_t base_revision,
                            std::span<const BlockIndex> blocks, const IsSent& is_sent) {
  MeshInParts(
      map, blocks, shown_, options_, [&](size_t part, size_t parts, std::vector<BlockMesh> meshes) {
        std::erase_if(meshes, [&](const BlockMesh& block) { return !is_sent(block); });
        bus_->Publish(kMeshDeltaChannel, Encode(MeshUpdate{map.last_utime,
                                                           map_id_,
                                                           base_revision,
                                                           base_revision < 0,
                                                           static_cast<int32_t>(part),
                                                           static_cast<int32_t>(parts),
                                                           map.voxels.block_size(),
                                                           {revision_, std::move(meshes)}}));
      });
  last_published_ = MonotonicSeconds();
}

std::string MeshPublisher::DigestOf(const SemanticMap& map, const MeshingOptions& options) {
  MeshDigest digest;
  MeshInParts(
      map, BlocksNearSurfaces(map.voxels), ShowLabels(map.labels), options,
      [&](size_t, size_t, std::vector<BlockMesh> meshes) {
        MeshUpdate update{0, "", -1, true, 0, 1, map.voxels.block_size(), {}};
        update.mesh.blocks = std::move(meshes);
        for (const mesh_block_t& block : Encode(update).blocks) {
          digest.Set({block.index[0], block.index[1], block.index[2]}, MeshDigest::HashOf(block));
        }
      });
  return digest.Hex();
}

}  // namespace vismap
