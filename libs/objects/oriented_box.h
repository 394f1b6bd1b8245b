#pragma once

#include <Eigen/Geometry>
#include <span>
#include <utility>
#include <vector>

namespace vismap {

/// An upright box: its third axis is the upward direction that it was fitted with, and its first
/// axis is the longer one of the two horizontal axes.
struct OrientedBox {
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();         ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();             ///< full edge lengths [m]
  Eigen::Quaterniond R_W_B = Eigen::Quaterniond::Identity();  ///< box axes to world
};

/// The upright box with the smallest base area around points of W [m]. Along each axis, the share
/// `outliers` of the points is left outside, half of it at each end. Zero size if there are no
/// points. `up_W` has unit length.
OrientedBox FitUprightBox(std::span<const Eigen::Vector3f> points_W, const Eigen::Vector3d& up_W,
                          double outliers);

/// The points without small, distant parts. Parts are groups of points that are separated from all
/// others by more than about `gap` [m]. Parts with less than the share `min_share` of all points
/// are dropped, but never the largest part. A gap of 0 keeps all points.
std::vector<Eigen::Vector3f> MainParts(std::span<const Eigen::Vector3f> points_W, double gap,
                                       double min_share);

/// A plane fitted to points.
struct PlaneFit {
  Eigen::Vector3d normal_W = Eigen::Vector3d::UnitZ();  ///< unit length, of either sign
  Eigen::Vector3d point_W = Eigen::Vector3d::Zero();
  double inliers = 0;    ///< share of the points within `flatness` of it, [0, 1]
  double roughness = 0;  ///< root mean square distance of the points within 2 * `flatness` [m]
};
/// The least-squares plane through the points, fitted again twice to the points within 2 *
/// `flatness` [m] of the plane before. The default for fewer than 3 points; `inliers` stays 0 if
/// fewer than 3 points are near the plane.
PlaneFit FitPlane(std::span<const Eigen::Vector3f> points_W, double flatness);

/// Two horizontal unit vectors that form a right-handed frame with `up_W` as the third. They are
/// the x and y axes of W if `up_W` is z.
std::pair<Eigen::Vector3d, Eigen::Vector3d> HorizontalAxes(const Eigen::Vector3d& up_W);

}  // namespace vismap
