#include "objects/mesh_tracker.h"

#include <algorithm>
#include <utility>

#include "objects/read_out.h"

namespace vismap {
namespace {

constexpr size_t kBlocksPerPart = 512;  // a few megabytes of mesh

std::vector<BlockIndex> BlocksNearSurfaces(const VoxelMap& map) {
  std::vector<BlockIndex> blocks;
  map.blocks().ForEach([&](BlockIndex index, const Block& block) {
    if (block.surface) blocks.push_back(index);
  });
  return BlocksToMesh(map, blocks);
}

// Calls `receive(part, parts, meshes)` at least once.
template <typename Receive>
void MeshInParts(const SemanticMap& map, std::span<const BlockIndex> blocks,
                 std::span<const ShownLabel> shown, const MeshingOptions& options,
                 const Receive& receive) {
  const size_t parts = std::max<size_t>(1, (blocks.size() + kBlocksPerPart - 1) / kBlocksPerPart);
  for (size_t part = 0; part < parts; ++part) {
    const auto rest = blocks.subspan(part * kBlocksPerPart);
    const auto some = rest.first(std::min(rest.size(), kBlocksPerPart));
    receive(part, parts, MeshEachBlock(map, some, shown, options));
  }
}

}  // namespace

void MeshTracker::Start(const SemanticMap& map) {
  const std::vector<BlockIndex> all = map.voxels.SortedIndices();
  revision_ = -1;
  dirty_.Clear();
  dirty_.Add(all);
  shown_ = ShowLabels(map.labels);
  places_.Clear();
  places_.AddBlocks(map.voxels, all);
  places_.MergeAll(map.labels);
  surfaces_.Clear();
  log_.Clear();
}

void MeshTracker::AddChanges(const SemanticMap& map, const BlockChanges& changes,
                             std::span<const std::pair<SegmentLabel, SegmentLabel>> merged) {
  places_.AddBlocks(map.voxels, changes.blocks);
  for (const auto& [dead, survivor] : merged) places_.Merge(dead, survivor);
  dirty_.Add(changes);
}

void MeshTracker::AddBlocksShownDifferently(const SemanticMap& map) {
  std::vector<ShownLabel> now = ShowLabels(map.labels);
  for (size_t i = 0; i < shown_.size(); ++i) {  // new labels are in blocks that changed anyway
    if (now[i] == shown_[i]) continue;
    dirty_.Add(places_.BlocksOf(static_cast<SegmentLabel>(i)));
  }
  shown_ = std::move(now);
}

// Whether followers must hear of the block: it has a surface, or had one.
bool MeshTracker::RecordSurface(const SemanticMap& map, const BlockMesh& block) {
  if (!surfaces_.Update(block, map.voxels.voxel_size())) return false;
  log_.Record(map.revision, block.block);
  return true;
}

void MeshTracker::Mesh(const SemanticMap& map, int64_t base_revision,
                       std::span<const BlockIndex> blocks,
                       const std::function<bool(const BlockMesh&)>& is_handed_over,
                       const Receiver& receive) {
  MeshInParts(map, blocks, shown_, options_,
              [&](size_t part, size_t parts, std::vector<BlockMesh> meshes) {
                std::erase_if(meshes, [&](const BlockMesh& b) { return !is_handed_over(b); });
                receive({base_revision, revision_, part, parts, std::move(meshes)});
              });
}

void MeshTracker::MeshChanges(const SemanticMap& map, const Receiver& receive) {
  AddBlocksShownDifferently(map);
  const std::vector<BlockIndex> blocks = dirty_.TakeBlocksToMesh(map.voxels);
  const int64_t base = std::exchange(revision_, map.revision);
  Mesh(
      map, base, blocks, [&](const BlockMesh& block) { return RecordSurface(map, block); },
      receive);
}

void MeshTracker::MeshAll(const SemanticMap& map, const Receiver& receive) {
  dirty_.Clear();
  shown_ = ShowLabels(map.labels);
  revision_ = map.revision;
  // A follower with an older state of this map needs all surfaces again, and must hear of those
  // that are gone.
  for (const BlockIndex& block : surfaces_.Blocks()) log_.Record(map.revision, block);
  surfaces_.Clear();
  Mesh(
      map, -1, BlocksNearSurfaces(map.voxels),
      [&](const BlockMesh& block) { return RecordSurface(map, block); }, receive);
}

void MeshTracker::MeshSince(const SemanticMap& map, int64_t revision, const Receiver& receive) {
  MeshBlocksOf(GapSince(map, revision, receive), map, options_, receive);
}

MeshGap MeshTracker::GapSince(const SemanticMap& map, int64_t revision, const Receiver& receive) {
  const bool known = revision >= 0 && revision <= revision_, first = revision_ < 0;
  if (known || has_changes() || revision_ != map.revision) MeshChanges(map, receive);
  if (first) return {revision_, revision_, {}, {}};  // that was the whole surface
  MeshGap gap{revision, revision_, {}, shown_};
  if (auto changed = known ? log_.Since(revision) : std::nullopt) {
    gap.blocks = std::move(*changed);
  } else {
    gap.base_revision = -1;
    gap.blocks = surfaces_.Blocks();
  }
  return gap;
}

void MeshBlocksOf(const MeshGap& gap, const SemanticMap& map, const MeshingOptions& options,
                  const MeshTracker::Receiver& receive) {
  std::vector<BlockIndex> blocks = gap.blocks;
  std::sort(blocks.begin(), blocks.end());
  MeshInParts(map, blocks, gap.shown, options,
              [&](size_t part, size_t parts, std::vector<BlockMesh> meshes) {
                receive({gap.base_revision, gap.revision, part, parts, std::move(meshes)});
              });
}

void MeshWholeMap(const SemanticMap& map, const MeshingOptions& options,
                  const std::function<void(std::vector<BlockMesh>)>& receive) {
  MeshInParts(map, BlocksNearSurfaces(map.voxels), ShowLabels(map.labels), options,
              [&](size_t, size_t, std::vector<BlockMesh> meshes) { receive(std::move(meshes)); });
}

}  // namespace vismap
