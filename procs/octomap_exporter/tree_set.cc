#include "octomap_exporter/tree_set.h"

#include <utility>

namespace vismap {

namespace {

std::vector<BlockIndex> IndicesOf(const OccupancyDelta& delta) {
  std::vector<BlockIndex> indices;
  for (const auto& entry : delta.blocks) indices.push_back(entry.first);
  return indices;
}

}  // namespace

Result<TreeSet> TreeSet::Make(double voxel_size, const VismapConfig& config) {
  Result<OctreeBuilder> fine = OctreeBuilder::Make(voxel_size, config.octree);
  if (!fine) return tl::unexpected(fine.error());
  TreeSet set(std::move(*fine), config.octomap_exporter.unknown);
  if (config.octomap_exporter.coarse_resolution_m > 0) {
    OctreeOptions options = config.octree;
    options.resolution_m = config.octomap_exporter.coarse_resolution_m;
    Result<OctreeBuilder> coarse = OctreeBuilder::Make(voxel_size, options);
    if (!coarse) return tl::unexpected(coarse.error());
    set.coarse_.emplace(std::move(*coarse));
  }
  set.closed_ = config.octree;
  set.closed_.resolution_m = set.resolution();
  set.closed_.unknown = UnknownPolicy::kOccupied;
  if (const double radius = config.octomap_exporter.clear_start_m; radius > 0)
    set.clearer_.emplace(radius, set.fine_.leaves().cell_size());
  if (const Result<void> made = set.AddInflated(config); !made) return tl::unexpected(made.error());
  return set;
}

Result<void> TreeSet::AddInflated(const VismapConfig& config) {
  radius_ = config.octomap_exporter.robot_radius_m;
  if (radius_ <= 0) return {};
  Result<Inflater> inflater = Inflater::Make(leaves().cell_size(), {.radius_m = radius_});
  if (!inflater) return tl::unexpected(inflater.error());
  inflater_.emplace(std::move(*inflater));
  return {};
}

Result<void> TreeSet::AddPath(std::span<const Eigen::Vector3d> path_W) {
  return clearer_ ? clearer_->AddPath(path_W) : Result<void>();
}

OccupancyDelta TreeSet::UpdateCleared(const OccupancyDelta& seen) {
  OccupancyDelta delta = clearer_->Update(fine_.leaves(), IndicesOf(seen));
  cleared_.Update(clearer_->leaves(), IndicesOf(delta));
  assumed_ = clearer_->Assumed();
  return delta;
}

void TreeSet::UpdateInflated(const OccupancyDelta& changed) {
  const OccupancyDelta delta = inflater_->Update(leaves(), IndicesOf(changed));
  inflated_.Update(inflater_->inflated(), IndicesOf(delta));
}

OccupancyDelta TreeSet::Update(const OccupancyMap& map, std::span<const BlockIndex> changed) {
  OccupancyDelta delta = fine_.Update(map, changed);
  if (clearer_) delta = UpdateCleared(delta);
  delta.voxel_size = resolution();  // without the error of rounding that a product has
  delta.complete = !std::exchange(has_leaves_, true);
  if (inflater_) UpdateInflated(delta);
  if (coarse_) coarse_->Update(map, changed);
  return delta;
}

Result<PublishedTree> TreeSet::BuildClosed() {
  const bool clear = clearer_ && policy_ == UnknownPolicy::kOccupied;
  Result<OctreeBytes> octree =
      clear ? cleared_.Encode(clearer_->leaves(), closed_) : fine_.Build(policy_);
  if (!octree) return tl::unexpected(octree.error());
  return PublishedTree{kOctomapChannel, std::move(*octree), 0,
                       clear ? assumed_ : std::vector<VoxelIndex>()};
}

Result<PublishedTree> TreeSet::BuildInflated() {
  Result<OctreeBytes> octree = inflated_.Encode(inflater_->inflated(), closed_);
  if (!octree) return tl::unexpected(octree.error());
  PublishedTree tree{kOctomapInflatedChannel, std::move(*octree), radius_, {}};
  for (const VoxelIndex& leaf : assumed_) {
    if (inflater_->inflated().At(leaf) == CellState::kFree) tree.assumed_free.push_back(leaf);
  }
  return tree;
}

Result<std::vector<PublishedTree>> TreeSet::Build() {
  std::vector<PublishedTree> trees;
  // The closed tree comes first: it is what planners wait for.
  Result<PublishedTree> closed = BuildClosed();
  if (!closed) return tl::unexpected(closed.error());
  trees.push_back(std::move(*closed));
  Result<OctreeBytes> raw = fine_.Build(UnknownPolicy::kAbsent);
  if (!raw) return tl::unexpected(raw.error());
  trees.push_back({kOctomapRawChannel, std::move(*raw), 0, {}});
  if (inflater_) {
    Result<PublishedTree> inflated = BuildInflated();
    if (!inflated) return tl::unexpected(inflated.error());
    trees.push_back(std::move(*inflated));
  }
  if (!coarse_) return trees;
  Result<OctreeBytes> coarse = coarse_->Build(UnknownPolicy::kOccupied);
  if (!coarse) return tl::unexpected(coarse.error());
  trees.push_back({kOctomapCoarseChannel, std::move(*coarse), 0, {}});
  return trees;
}

}  // namespace vismap
