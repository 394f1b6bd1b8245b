#pragma once

#include <Eigen/Core>
#include <map>
#include <span>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

// A robot stands where its own body kept the camera from seeing anything, so that its position is
// unknown space, in which no planner may start. But its body is there, so nothing else is.

/// The body of a robot around its pose: a sphere, or a vertical cylinder (vertical = along z of W).
struct RobotBody {
  double radius_m = 0.2;  ///< of the sphere or the cylinder [m], more than 0
  /// The cylinder ends so far below and above the pose [m]; both 0 = a sphere.
  double below_m = 0, above_m = 0;
};

/// Sets of leaves by block.
using LeafSets = std::map<BlockIndex, VoxelBits>;

/// The unknown leaves that the body covered while it moved along the path, on straight lines from
/// one pose to the next; a path of one pose is a place. A leaf is covered when the gap between its
/// box and the box of a leaf that the pose went through is less than the radius (and overlaps the
/// height of the cylinder); so the body counts as up to one leaf larger, and a robot of that radius
/// may start in the inflated map. Leaves that are free or occupied are never in the result. Fails
/// on a radius that is not positive or more than 100 leaves, a height that is negative or more than
/// 10 m, and a position that is not finite or farther than 1e6 leaves from the origin.
Result<LeafSets> CoveredUnknownLeaves(const OccupancyMap& leaves, const RobotBody& body,
                                      std::span<const Eigen::Vector3d> path_W);

/// The block with these leaves free. Throws std::logic_error when one of them is occupied.
BlockOccupancy WithFreeLeaves(const BlockOccupancy& block, const VoxelBits& free);

}  // namespace vismap
