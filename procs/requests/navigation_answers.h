#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "navigation/distance_field.h"
#include "navigation/ground_grid.h"
#include "requests/request_server.h"

namespace vismap {

/// The space that questions of planners are answered from, and what holds when they state nothing.
/// What it points to must outlive it.
struct NavigationSpace {
  const OccupancyMap* voxels = nullptr;
  /// Leaves that are at hand; nullptr = they are made from the voxels when they are needed.
  const OccupancyMap* leaves = nullptr;
  const DistanceField* field = nullptr;  ///< of these leaves; nullptr = computed when needed
  bool is_edited = false;  ///< what the request names in `without` is left out of the voxels
  std::string map_id;
  int64_t revision = 0;
  int64_t utime = 0;  ///< of the newest frame in the map [us]
  OctreeOptions octree;
  GroundGridOptions grid;
  double distance_limit_m = 2.0;
  double robot_radius_m = 0.2;  ///< for viewpoints
  /// Positions of the camera, see MakeGroundGrid [m].
  std::vector<Eigen::Vector3d> path_W;
};

// All of these fail with one sentence that names the field or key, what was found and what is
// allowed: on unknown keys, numbers that are not finite or out of range, and boxes that are
// inverted or empty. They take time in proportion to the box of the request.

/// "grid": an occupancy_grid_t. Keys: height, step, slope, band=a,b, limit, see GroundGridOptions.
/// A box restricts it to the blocks of 8^3 voxels that the box touches.
Result<Answer> AnswerGrid(const NavigationSpace& space, const map_request_t& request);

/// "distances": a distance_field_t with all blocks of 8^3 leaves that the box touches. Key: limit.
Result<Answer> AnswerDistances(const NavigationSpace& space, const map_request_t& request);

/// "clearance": JSON with distance, gradient and what is nearest, of each point. Keys:
/// at=x,y,z;x,y,z, limit.
Result<Answer> AnswerClearance(const NavigationSpace& space, const map_request_t& request);

/// "frontiers": JSON with size, centre and viewpoint of each frontier whose centre is in the box.
/// Keys: cluster, least, see FrontierOptions; the radius of the robot is inflate_m of the request.
Result<Answer> AnswerFrontiers(const NavigationSpace& space, const map_request_t& request);

}  // namespace vismap
