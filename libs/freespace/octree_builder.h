#pragma once

#include <span>

#include "freespace/coarsen.h"
#include "freespace/octree_cache.h"

namespace vismap {

/// Makes octrees of a map that changes, for the price of what changed: the same, byte for byte, as
/// BuildOctree of the whole map. Holds the map in cells of the leaf size.
class OctreeBuilder {
 public:
  /// For a map with voxels of `voxel_size` [m]. `options.unknown` has no meaning here. Fails on a
  /// resolution that does not fit the voxels, or a free_fraction outside (0, 1].
  static Result<OctreeBuilder> Make(double voxel_size, const OctreeOptions& options);

  /// Takes over the blocks of `map` that are different from the last time, or may be, in any order.
  /// At first: all of them. Throws when the voxel size is another.
  void Update(const OccupancyMap& map, std::span<const BlockIndex> changed);

  /// The octree of the map as at the last Update. Fails as BuildOctree does.
  Result<OctreeBytes> Build(UnknownPolicy unknown);

  int64_t encoded_cubes() const { return cache_.encoded(); }  ///< see OctreeCache

 private:
  OctreeBuilder(double voxel_size, const OctreeGrid& grid, const OctreeOptions& options);

  double voxel_size_;
  double resolution_;
  CoarsenOptions coarsening_;
  std::optional<Eigen::AlignedBox3d> bounds_W_;
  OccupancyMap leaves_;
  OctreeCache cache_;
};

}  // namespace vismap
