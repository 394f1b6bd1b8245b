#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/camera.h"
#include "segmentation/regions.h"

namespace vismap {

/// Sums over the pixels of a region, from which the plane through it follows by least squares. A
/// plane is w = k . a, with w = inverse depth [1/m] and a = (x, y, 1), the ray through the pixel.
struct PlaneMoments {
  Eigen::Matrix3d aa = Eigen::Matrix3d::Zero();  ///< sum of a a^T
  Eigen::Vector3d aw = Eigen::Vector3d::Zero();  ///< sum of a w
  double ww = 0;                                 ///< sum of w^2
  double variance = 0;                           ///< sum of the expected variances of w

  double count() const { return aa(2, 2); }
  void Add(const PlaneMoments& other);
  /// k of the plane with the least squared error.
  Eigen::Vector3d Plane() const;
  /// Mean of w - k . a [1/m].
  double MeanError(const Eigen::Vector3d& k) const;
  /// Mean of (w - k . a)^2 [1/m^2].
  double MeanSquaredError(const Eigen::Vector3d& k) const;
};

/// Two regions a < b that touch: `pairs` pairs of neighbouring pixels are linked across the border.
struct Contact {
  int32_t a = 0, b = 0;
  int32_t pairs = 0;
};

/// An image of regions without its pixels: what the joining of regions needs. The vectors are
/// indexed by region number; entry 0 is not used.
struct RegionGraph {
  RunTable runs;
  std::vector<PlaneMoments> moments;
  std::vector<Eigen::Vector3d> normals;  ///< sum over the region's pixels
  std::vector<int32_t> pixels;           ///< number of pixels
  std::vector<Contact> contacts;         ///< ascending by (a, b)
};

/// Measures the regions of an image, in one pass over its pixels.
RegionGraph MakeRegionGraph(const SurfaceMap& surface, const PinholeCamera& camera,
                            const Image<uint8_t>& links, const Regions& regions);

/// Joins regions that lie on one plane, so that noise does not shatter walls and floors. Returns
/// the host of each region: the region that it was joined to, or itself.
///
/// From the largest region down, each planar one joins its touching neighbours that lie on its
/// plane within the noise, and their neighbours, and fits its plane again after each. With s =
/// max_sigmas and σ = expected standard deviation of the neighbour's inverse depth: |mean of
/// w - k . a| < s σ / 2 and mean of (w - k . a)^2 < (s σ)^2.
std::vector<int32_t> JoinCoplanarRegions(const RegionGraph& graph, double max_sigmas);

/// Joins small regions, those below `min_pixels` after the joining in `hosts`, to the neighbour
/// that they share more than half of their border with, if it is not small and the mean normals are
/// within `max_angle` [rad]. The other small regions get the host 0: they belong to no segment.
std::vector<int32_t> JoinSmallRegions(const RegionGraph& graph, std::vector<int32_t> hosts,
                                      int min_pixels, double max_angle);

/// The runs of all regions that JoinSmallRegions changed the host of, from `before` to `after`.
std::vector<LooseRun> LooseRuns(const RegionGraph& graph, const std::vector<int32_t>& before,
                                const std::vector<int32_t>& after);

/// The image of segments. Regions with the same host are one segment, regions with host 0 belong to
/// none. Segments are numbered 0..n-1 by their first pixel in row order.
SegmentImage PaintSegments(const RegionGraph& graph, const std::vector<int32_t>& hosts, int width);

}  // namespace vismap
