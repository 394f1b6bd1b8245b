#include "freespace/octree_builder.h"

#include "base/require.h"
#include "freespace/shortest_text.h"

namespace vismap {

OctreeBuilder::OctreeBuilder(double voxel_size, const OctreeGrid& grid,
                             const OctreeOptions& options)
    : voxel_size_(voxel_size),
      encoding_(options),
      coarsener_(voxel_size, {grid.factor, options.free_fraction}) {
  encoding_.resolution_m = grid.resolution;
}

Result<OctreeBuilder> OctreeBuilder::Make(double voxel_size, const OctreeOptions& options) {
  const Result<OctreeGrid> grid = ChooseOctreeGrid(voxel_size, options.resolution_m);
  if (!grid) return tl::unexpected(grid.error());
  if (!(options.free_fraction > 0 && options.free_fraction <= 1)) {
    return Fail("octree free_fraction: expected a number above 0 and at most 1, found " +
                ShortestText(options.free_fraction));
  }
  return OctreeBuilder(voxel_size, *grid, options);
}

OccupancyDelta OctreeBuilder::Update(const OccupancyMap& map, std::span<const BlockIndex> changed) {
  Require(map.cell_size() == voxel_size_, "an octree is built of one map");
  OccupancyDelta delta = coarsener_.Update(map, changed);
  std::vector<BlockIndex> indices;
  indices.reserve(delta.blocks.size());
  for (const auto& entry : delta.blocks) indices.push_back(entry.first);
  cache_.Update(leaves(), indices);
  return delta;
}

Result<OctreeBytes> OctreeBuilder::Build(UnknownPolicy unknown) {
  encoding_.unknown = unknown;
  return cache_.Encode(leaves(), encoding_);
}

}  // namespace vismap
