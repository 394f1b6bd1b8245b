#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"
#include "freespace/octree.h"

namespace vismap {

// This room makes of free space what planners and wheels need: inflated leaves, distances, grids,
// frontiers. A leaf is a cell of an OccupancyMap that was coarsened to the leaves of an octree. The
// methods are described in libs/METHOD.md, Navigation.

/// How obstacles grow by the radius of a robot.
struct InflateOptions {
  double radius_m = 0.2;  ///< [m], at least 0, at most kMostInflatedLeaves leaves; 0 = no growth
  /// kOccupied: unknown leaves are obstacles, as in a closed octree, and so is all space outside of
  /// the map. kAbsent: only occupied leaves are obstacles.
  UnknownPolicy unknown = UnknownPolicy::kOccupied;
};

/// The largest radius [leaves].
inline constexpr int kMostInflatedLeaves = 28;

/// Keeps an inflated copy of a map of leaves. A known leaf is occupied in the copy when the gap
/// between its box and the box of an obstacle is less than the radius; so a robot whose centre is
/// anywhere in a free leaf has a ball of that radius without obstacles around it. A leaf is free
/// when it was free and no obstacle is so near. Unknown leaves stay unknown, so that the copy has
/// the bounds of the map; only with kAbsent those near an obstacle become occupied.
class Inflater {
 public:
  /// `leaf_m`: edge of a leaf [m]. Fails on a radius that is out of range; the Error names the key
  /// octomap_exporter.robot_radius_m.
  static Result<Inflater> Make(double leaf_m, const InflateOptions& options);

  /// Must be called with the blocks of `leaves` that may have changed since the last call. Returns
  /// the blocks of the copy that changed. The copy is equal to that of an Inflater that has seen
  /// only the last state. Throws std::logic_error when `leaves` has leaves of another size.
  OccupancyDelta Update(const OccupancyMap& leaves, std::span<const BlockIndex> changed);

  const OccupancyMap& inflated() const { return inflated_; }
  OccupancyMap Take() && { return std::move(inflated_); }

 private:
  /// Leaves of a row that are obstacles count within `half_width` leaves when the row is `dy` rows
  /// and `dz` layers away.
  struct Reach {
    int dy = 0, dz = 0, half_width = 0;
  };

  Inflater(double leaf_m, const InflateOptions& options, int64_t nearest_free_gap2);
  VoxelBits ObstaclesIn(const BlockOccupancy& block) const;
  void AddAffected(BlockIndex index, const VoxelBits& differences,
                   std::vector<BlockIndex>* affected) const;
  std::vector<BlockIndex> TakeChanges(const OccupancyMap& leaves,
                                      std::span<const BlockIndex> changed);
  BlockOccupancy Inflate(BlockTable<BlockOccupancy>::Reader* leaves, BlockIndex index) const;
  VoxelBits Grow(BlockTable<BlockOccupancy>::Reader* leaves, BlockIndex index) const;

  UnknownPolicy unknown_;
  int reach_ = 0;                      // leaves along an axis, beyond which none is too near
  std::vector<Reach> rows_;            // all rows within reach
  BlockTable<BlockOccupancy> leaves_;  // as at the last Update
  OccupancyMap inflated_;
};

/// The whole map inflated, see Inflater.
Result<OccupancyMap> Inflate(const OccupancyMap& leaves, const InflateOptions& options);

}  // namespace vismap
