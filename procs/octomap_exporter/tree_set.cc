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
  return set;
}

OccupancyDelta TreeSet::Update(const OccupancyMap& map, std::span<const BlockIndex> changed) {
  OccupancyDelta delta = fine_.Update(map, changed);
  delta.voxel_size = resolution();  // without the error of rounding that a product has
  delta.complete = !std::exchange(has_leaves_, true);
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
  if (!coarse_) return trees;
  const Result<void> made = add(kOctomapCoarseChannel, &*coarse_, UnknownPolicy::kOccupied);
  if (!made) return tl::unexpected(made.error());
  return trees;
}

}  // namespace vismap
