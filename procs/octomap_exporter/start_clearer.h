#pragma once

#include <span>
#include <vector>

#include "navigation/start_clearing.h"

namespace vismap {

/// Keeps a copy of leaves in which what the robot's own body covers is free where it was never
/// seen: an assumption, which ends where something is seen.
class StartClearer {
 public:
  /// A ball of `radius_m` around the positions counts as the body; `leaf_m`: edge of a leaf [m].
  StartClearer(double radius_m, double leaf_m)
      : body_{.radius_m = radius_m}, nothing_known_(leaf_m), leaves_(leaf_m) {}

  /// Further positions of the robot [m]. Between two that are less than half a metre apart, it
  /// moved on a straight line. Fails as CoveredUnknownLeaves.
  Result<void> AddPath(std::span<const Eigen::Vector3d> path_W);

  /// Must be called with the blocks of `seen` that may have changed since the last call. Returns
  /// the blocks of leaves() that changed.
  OccupancyDelta Update(const OccupancyMap& seen, std::span<const BlockIndex> changed);

  /// What was seen, and what is assumed.
  const OccupancyMap& leaves() const { return leaves_; }
  /// The leaves that are free though they were never seen, ascending by block.
  std::vector<VoxelIndex> Assumed() const;

 private:
  RobotBody body_;
  OccupancyMap nothing_known_;           // stays empty, so that all covered leaves are found
  std::vector<Eigen::Vector3d> last_W_;  // the last position; empty = none yet
  LeafSets covered_;                     // by the body, whatever was seen there
  std::vector<BlockIndex> news_;         // blocks with more covered leaves since the last Update
  LeafSets assumed_;
  OccupancyMap leaves_;
};

}  // namespace vismap
