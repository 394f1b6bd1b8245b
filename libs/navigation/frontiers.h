#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// Where a map can be made larger: free leaves with an unknown leaf at one of their six faces.
struct Frontier {
  std::vector<VoxelIndex> leaves;                      ///< ascending
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();  ///< mean of the leaves' centres [m]
  Eigen::Vector3d member_W = Eigen::Vector3d::Zero();  ///< centre of the leaf nearest to it [m]
  /// From where it can be looked at [m]: a leaf that is free in the inflated map, from which the
  /// way to at least half of the leaves (of a sample of 16) leads through free leaves only; nullopt
  /// when there is none within the distances of the options.
  std::optional<Eigen::Vector3d> viewpoint_W;
};

struct FrontierOptions {
  /// Clusters do not extend beyond cubes of this edge, which are counted from the origin of W [m].
  double cluster_m = 1.0;
  int min_leaves = 8;  ///< smaller clusters are left out
  /// Viewpoints are as near to the best distance from the member leaf as they can be [m].
  double best_view_m = 1.0, min_view_m = 0.4, max_view_m = 2.0;
};

/// The frontiers of a map, the largest first; of equal size by their first leaf. `inflated` is the
/// inflated map of the same leaves, see Inflater. Fails on options out of range; throws
/// std::logic_error when the maps have leaves of different sizes.
Result<std::vector<Frontier>> FindFrontiers(const OccupancyMap& leaves,
                                            const OccupancyMap& inflated,
                                            const FrontierOptions& options);

}  // namespace vismap
