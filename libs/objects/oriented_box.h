#pragma once

#include <Eigen/Geometry>
#include <span>
#include <utility>
#include <vector>

namespace vismap {

/// A box that stands upright: its third axis is the up direction it was fitted with, the first is
/// the longer horizontal one.
struct OrientedBox {
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();         ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();             ///< full edge lengths [m]
  Eigen::Quaterniond R_W_B = Eigen::Quaterniond::Identity();  ///< box axes to world
};

/// The upright box with the smallest base around points of W [m], after `outliers` of the points
/// (half on either end of each axis) are left outside. Zero size for no points. `up_W` is unit.
OrientedBox FitUprightBox(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3d& up_W,
                          double outliers);

/// The points that belong to the main body: pieces separated by more than about `gap` [m] from
/// everything else are dropped when they hold less than `min_share` of the points. A gap of 0 keeps
/// all points.
std::vector<Eigen::Vector3f> MainParts(std::span<const Eigen::Vector3f> points_W, double gap,
                                       double min_share);

/// Least-squares plane through the points, refitted twice to those within `flatness` [m] x 2.
struct PlaneFit {
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< unit, either side
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  double inliers = 0;    ///< share of the points within `flatness` of it, [0, 1]
  double roughness = 0;  ///< root mean square distance of those within 2 x `flatness` [m]
};
PlaneFit FitPlane(std::span<const Eigen::Vector3f> points_W, double flatness);

/// A right-handed pair of unit vectors across `up_W`: x and y of the world when up is z.
std::pair<Eigen::Vector3d, Eigen::Vector3d> HorizontalAxes(const Eigen::Vector3d& up_W);

}  // namespace vismap
