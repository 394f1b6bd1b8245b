#pragma once

#include <cstdint>
#include <span>

#include "datasets/dataset.h"
#include "freespace/occupancy_map.h"

namespace vismap {

/// What a map says at points that are known to be free, or known to be surface.
struct CellShares {
  int64_t samples = 0, free = 0, occupied = 0, unknown = 0;
  void Add(CellState state);
};

/// The cells at points of a true surface [m]. A surface in a free cell is the dangerous error: a
/// planner would drive there.
CellShares CellsAt(const OccupancyMap& map, std::span<const Eigen::Vector3f> points_W);

/// Occupied cells whose centre has no point of the truth within `margin` [m]: invented obstacles,
/// as far as the truth is complete.
struct InventedCells {
  int64_t occupied = 0, far_from_truth = 0;
};
InventedCells CountInvented(const OccupancyMap& map, std::span<const Eigen::Vector3f> points_W,
                            double margin);

/// Which samples to take of depth images.
struct RayOptions {
  size_t frame_step = 10;
  int pixel_step = 8;                     ///< from half of it
  double min_depth = 0.4, max_depth = 3;  ///< of the pixels to take, along the optical axis [m]
  double first = 0.3, step = 0.1;         ///< of the samples along a ray, from the camera [m]
  double margin = 0.15;                   ///< they end so far before the measured surface [m]
};

/// A map against measured depth: along each ray space is free up to the surface.
struct RayScore {
  CellShares free;     ///< samples along the rays
  CellShares surface;  ///< where they end
};
Result<RayScore> ScoreRays(const OccupancyMap& map, const Dataset& dataset,
                           const RayOptions& options);

}  // namespace vismap
