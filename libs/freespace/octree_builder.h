#pragma once

#include <span>

#include "freespace/coarsener.h"
#include "freespace/octree_cache.h"

namespace vismap {

/// Makes octrees of a map that changes, in time proportional to the changes. The bytes are the same
/// as those of BuildOctree for the whole map. Holds the map in cells of the size of leaves.
class OctreeBuilder {
 public:
  /// For a map with voxels of `voxel_size` [m]. `options.unknown` is not used. Fails on a
  /// resolution that is no multiple of the voxel size, and on a free_fraction outside (0, 1].
  static Result<OctreeBuilder> Make(double voxel_size, const OctreeOptions& options);

  /// Updates the leaves from the blocks of `map` that may have changed since the last call, in any
  /// order; the first call needs all blocks. Returns the blocks of leaves() that changed. Throws
  /// std::logic_error on another voxel size.
  OccupancyDelta Update(const OccupancyMap& map, std::span<const BlockIndex> changed);

  /// The octree of the map at the last Update. Fails as BuildOctree does.
  Result<OctreeBytes> Build(UnknownPolicy unknown);

  double resolution() const { return encoding_.resolution_m; }  ///< edge of a leaf [m]
  /// The map in cells of the size of leaves.
  const OccupancyMap& leaves() const { return coarsener_.coarse(); }
  int64_t encoded_cubes() const { return cache_.encoded(); }  ///< see OctreeCache

 private:
  OctreeBuilder(double voxel_size, const OctreeGrid& grid, const OctreeOptions& options);

  double voxel_size_;
  OctreeOptions encoding_;  // its resolution is that of the leaves
  Coarsener coarsener_;
  OctreeCache cache_;
};

}  // namespace vismap
