#pragma once

#include <cstdint>
#include <span>

#include "datasets/dataset.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// The states of the cells of a map at sample points whose true state is known.
struct CellShares {
  int64_t samples = 0, free = 0, occupied = 0, unknown = 0;
  void Add(CellState state);
};

/// The states of the cells at points of the true surface in W [m]. A free cell here is a dangerous
/// error, because a planner would plan through the surface.
CellShares CellsAt(const OccupancyMap& map, std::span<const Eigen::Vector3f> points_W);

/// The number of occupied cells, and of those whose centre has no point of the true surface nearby.
/// The latter are false obstacles, as far as the ground truth is complete.
struct OccupiedCells {
  int64_t cells = 0, far_from_truth = 0;
};

/// Counts the occupied cells of a map. `margin` [m]: a cell is far from the truth if its centre has
/// no point of the true surface within this distance.
OccupiedCells CountOccupied(const OccupancyMap& map, std::span<const Eigen::Vector3f> points_W,
                            double margin);

/// Where depth images are sampled.
struct RayOptions {
  size_t frame_step = 10;                 ///< every so many frames, from the first
  int pixel_step = 8;                     ///< every so many pixels, from half of it
  double min_depth = 0.4, max_depth = 3;  ///< only pixels with depth in this range [m]
  double first = 0.3, step = 0.1;         ///< distances of the samples along a ray [m]
  double margin = 0.15;                   ///< samples end this far before the surface [m]
};

/// The states of a map's cells along measured rays, on which space is free up to the surface.
struct RayScore {
  CellShares free;     ///< at the samples before the surface
  CellShares surface;  ///< at the measured surface
};
/// Samples the depth images of a sequence. Frames that cannot be read are left out.
Result<RayScore> ScoreRays(const OccupancyMap& map, const Dataset& dataset,
                           const RayOptions& options);

}  // namespace vismap
