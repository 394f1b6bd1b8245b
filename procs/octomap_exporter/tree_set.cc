#include "octomap_exporter/tree_set.h"

#include <utility>

namespace vismap {

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
  if (const Result<void> made = set.AddInflated(config); !made) return tl::unexpected(made.error());
  return set;
}

Result<void> TreeSet::AddInflated(const VismapConfig& config) {
  radius_ = config.octomap_exporter.robot_radius_m;
  if (radius_ <= 0) return {};
  Result<Inflater> inflater = Inflater::Make(leaves().cell_size(), {.radius_m = radius_});
  if (!inflater) return tl::unexpected(inflater.error());
  inflater_.emplace(std::move(*inflater));
  inflated_options_ = config.octree;
  inflated_options_.resolution_m = resolution();
  inflated_options_.unknown = UnknownPolicy::kOccupied;
  return {};
}

void TreeSet::UpdateInflated(const OccupancyDelta& changed) {
  std::vector<BlockIndex> indices;
  for (const auto& entry : changed.blocks) indices.push_back(entry.first);
  const OccupancyDelta delta = inflater_->Update(leaves(), indices);
  indices.clear();
  for (const auto& entry : delta.blocks) indices.push_back(entry.first);
  inflated_.Update(inflater_->inflated(), indices);
}

OccupancyDelta TreeSet::Update(const OccupancyMap& map, std::span<const BlockIndex> changed) {
  OccupancyDelta delta = fine_.Update(map, changed);
  delta.voxel_size = resolution();  // without the error of rounding that a product has
  delta.complete = !std::exchange(has_leaves_, true);
  if (inflater_) UpdateInflated(delta);
  if (coarse_) coarse_->Update(map, changed);
  return delta;
}

Result<std::vector<PublishedTree>> TreeSet::Build() {
  std::vector<PublishedTree> trees;
  const auto add = [&](const Channel& channel, OctreeBuilder* builder, UnknownPolicy unknown) {
    Result<OctreeBytes> octree = builder->Build(unknown);
    if (octree) trees.push_back({channel, std::move(*octree)});
    return octree ? Result<void>() : tl::unexpected(octree.error());
  };
  // The closed tree comes first: it is what planners wait for.
  if (const Result<void> made = add(kOctomapChannel, &fine_, policy_); !made)
    return tl::unexpected(made.error());
  if (const Result<void> made = add(kOctomapRawChannel, &fine_, UnknownPolicy::kAbsent); !made)
    return tl::unexpected(made.error());
  if (inflater_) {
    Result<OctreeBytes> octree = inflated_.Encode(inflater_->inflated(), inflated_options_);
    if (!octree) return tl::unexpected(octree.error());
    trees.push_back({kOctomapInflatedChannel, std::move(*octree), radius_});
  }
  if (!coarse_) return trees;
  const Result<void> made = add(kOctomapCoarseChannel, &*coarse_, UnknownPolicy::kOccupied);
  if (!made) return tl::unexpected(made.error());
  return trees;
}

}  // namespace vismap
