#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <vismap/occupancy_grid_t.hpp>

#include "config/config.h"
#include "runtime/bus.h"
#include "runtime/clock.h"
#include "runtime/pacer.h"
#include "wire/map_follower.h"

namespace vismap {

/// Publishes grids for wheels on GRID while the map changes, and sends the newest again while it
/// stands still, as LatchedTrees does with trees.
class GridPublisher {
 public:
  static constexpr double kPeriod = 1.5;  ///< [s]

  /// `bus` must outlive it. Publishes nothing unless octomap_exporter.grid_period_s is set.
  GridPublisher(const VismapConfig& config, Bus* bus);

  /// Whether the period has passed, and the last grid is of another state of the map.
  bool IsDue(const FollowerPosition& position) const;
  /// Makes a grid and publishes it, or nothing while nothing is known. `path_W`: positions of the
  /// camera [m]. Fails as MakeGroundGrid.
  Result<void> Publish(const OccupancyMap& map, const FollowerPosition& position, int64_t utime,
                       std::span<const Eigen::Vector3d> path_W);
  /// Sends the newest grid again when it is due.
  void Repeat();
  /// Forgets the grid, since it is of a map that is gone.
  void Clear();

  /// What was sent last.
  const std::optional<occupancy_grid_t>& sent() const { return sent_; }

 private:
  Result<void> Make(const OccupancyMap& map, int64_t utime,
                    std::span<const Eigen::Vector3d> path_W);
  void Send();

  GroundGridOptions options_;
  double period_, budget_;  // [s], [bytes/s]
  Bus* bus_;
  Pacer pacer_;
  FollowerPosition made_;  // from this state of the map
  std::optional<occupancy_grid_t> sent_;
  double sent_at_ = 0;  // MonotonicSeconds
};

}  // namespace vismap
