#pragma once

#include <optional>
#include <vector>

#include "config/config.h"
#include "freespace/octree_builder.h"
#include "navigation/inflate.h"
#include "octomap_exporter/start_clearer.h"
#include "wire/channels.h"
#include "wire/map_follower.h"

namespace vismap {

/// One of the octrees that are published.
struct PublishedTree {
  Channel channel;
  OctreeBytes octree;
  double inflated_by = 0;                ///< see octree_t [m]
  std::vector<VoxelIndex> assumed_free;  ///< see octree_t
};

/// The octrees of a map that changes, see procs/README.md, Octrees. Takes time in proportion to
/// what changed.
class TreeSet {
 public:
  /// For a map with voxels of `voxel_size` [m]. Fails when a resolution is no multiple of that.
  static Result<TreeSet> Make(double voxel_size, const VismapConfig& config);

  /// Further positions of the robot, which count from the next Update on, see StartClearer [m].
  Result<void> AddPath(std::span<const Eigen::Vector3d> path_W);
  /// Must be called with the blocks of `map` that may have changed since the last call. Returns the
  /// leaves of the tree on OCTOMAP that changed; all of them, when it is the first call.
  OccupancyDelta Update(const OccupancyMap& map, std::span<const BlockIndex> changed);

  /// Whether no leaf is free or occupied.
  bool is_empty() const { return fine_.leaves().size() == 0; }
  /// The leaves of the tree on OCTOMAP, in blocks; their size is resolution().
  const OccupancyMap& leaves() const { return clearer_ ? clearer_->leaves() : fine_.leaves(); }
  size_t assumed_free() const { return assumed_.size(); }   ///< leaves
  double resolution() const { return fine_.resolution(); }  ///< edge of a leaf on OCTOMAP [m]

  /// All trees of the present state. Fails as BuildOctree does.
  Result<std::vector<PublishedTree>> Build();
  /// The tree for a file, of what was seen.
  Result<OctreeBytes> Build(UnknownPolicy unknown) { return fine_.Build(unknown); }

 private:
  TreeSet(OctreeBuilder fine, UnknownPolicy policy) : fine_(std::move(fine)), policy_(policy) {}
  Result<void> AddInflated(const VismapConfig& config);
  OccupancyDelta UpdateCleared(const OccupancyDelta& seen);
  void UpdateInflated(const OccupancyDelta& changed);
  Result<PublishedTree> BuildClosed();
  Result<PublishedTree> BuildInflated();

  OctreeBuilder fine_;
  UnknownPolicy policy_;  // of OCTOMAP
  std::optional<OctreeBuilder> coarse_;
  std::optional<StartClearer> clearer_;  // of the leaves of fine_
  OctreeCache cleared_;
  std::vector<VoxelIndex> assumed_;
  std::optional<Inflater> inflater_;  // of leaves()
  OctreeCache inflated_;
  OctreeOptions closed_;     // of the trees that are made of cleared_ and inflated_
  double radius_ = 0;        // by which inflater_ inflates [m]
  bool has_leaves_ = false;  // after the first Update
};

}  // namespace vismap
