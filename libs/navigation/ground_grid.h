#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// How a grid for a robot on wheels is made of free space. Heights are along z of W, which must
/// point upward.
struct GroundGridOptions {
  /// Edge of a grid cell [m]: a whole multiple of the map's cells, 1 to 64; 0 = the smallest such
  /// multiple of at least 5 cm.
  double resolution_m = 0;
  /// The floor is looked for, and the robot takes this height above it [m].
  double robot_height_m = 1.0;
  double step_height_m = 0.03;  ///< highest step that the robot takes, up and down [m]
  double max_slope_deg = 10;    ///< steepest slope that the robot takes [degrees]
  /// Instead of the floor: the heights z of W between these two count, for robots that fly or for
  /// scanners at one height [m]. Used when band_max_m is more than band_min_m.
  double band_min_m = 0, band_max_m = 0;
  double distance_limit_m = 2.0;  ///< up to here distances are computed [m]

  bool has_band() const { return band_max_m > band_min_m; }
};

/// Everything that is wrong with the options, one sentence each that begins with the key.
std::vector<std::string> Validate(const GroundGridOptions& options);

/// A grid on the x-y plane of W. Cell (x, y) is at index x + width y and covers
/// [origin + resolution (x, y), origin + resolution (x + 1, y + 1)).
struct GroundGrid {
  double resolution_m = 0;                             ///< edge of a cell [m]
  Eigen::Vector2d origin_W = Eigen::Vector2d::Zero();  ///< corner of cell (0, 0) [m]
  int width = 0, height = 0;  ///< cells along x and y; 0 = nothing is known
  std::vector<CellState> states;
  /// From the centre of a cell to the nearest face of a cell that is not free, or to the end of the
  /// grid, at most distance_limit_m [m]; 0 in cells that are not free.
  std::vector<float> distances_m;
  /// Height z of the floor in W [m]; NaN where none was found, and everywhere with a band.
  std::vector<float> floor_m;

  size_t Index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
};

/// Makes the grid of a map, by preference of its voxels, since heights are then known to one voxel.
///
/// Floor: what the robot can reach from below the path, over neighbouring cells whose heights
/// differ by no more than a step. Of several floors below the path (a table was below the camera)
/// the largest counts. `path_W` = positions of camera or robot [m]; empty = the largest floor of
/// the map. A cell is
/// - occupied when something is in the robot's way between the step height and the robot's height
///   above the floor; when the floor around it rises by more than a step or the steepest slope
///   within 0.3 m; or when the floor ends in a drop that was seen;
/// - free when there is floor in most of it, and all of the space above it is free up to the
///   robot's height;
/// - unknown otherwise.
///
/// Band: occupied when anything in the band is, free when all of it is free, else unknown.
///
/// Fails on options with problems, and on maps whose columns need more than 1 GB.
Result<GroundGrid> MakeGroundGrid(const OccupancyMap& map, const GroundGridOptions& options,
                                  std::span<const Eigen::Vector3d> path_W);

}  // namespace vismap
