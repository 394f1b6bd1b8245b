#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/camera.h"
#include "segmentation/regions.h"

namespace vismap {

/// Sums over a region's pixels of inverse depth w and a = (x, y, 1), where a plane is w = k . a.
struct PlaneMoments {
  Eigen::Matrix3d aa = Eigen::Matrix3d::Zero();
  Eigen::Vector3d aw = Eigen::Vector3d::Zero();
  double ww = 0;
  double variance = 0;  ///< expected variance of w, summed

  double count() const { return aa(2, 2); }
  void Add(const PlaneMoments& other);
  Eigen::Vector3d Plane() const;
  double MeanError(const Eigen::Vector3d& k) const;
  double MeanSquaredError(const Eigen::Vector3d& k) const;
};

/// Two regions that touch: `pairs` neighbouring pixels are linked across their border. a < b.
struct Contact {
  int32_t a = 0, b = 0;
  int32_t pairs = 0;
};

/// What joining regions needs to know of an image of them, without its pixels. Indexed by number,
/// of which 0 stands for none.
struct RegionGraph {
  RunTable runs;
  std::vector<PlaneMoments> moments;
  std::vector<Eigen::Vector3d> normals;  ///< summed
  std::vector<int32_t> pixels;
  std::vector<Contact> contacts;  ///< ascending
};

/// Reads the image once.
RegionGraph MakeRegionGraph(const SurfaceMap& surface, const PinholeCamera& camera,
                            const Image<uint8_t>& links, const Regions& regions);

/// For each region the number of the one that takes it in: itself, or one that lies on one plane
/// with it within the noise, so that noise cannot shatter walls and floors. From the largest region
/// down, each takes in the touching neighbours whose mean and spread about its plane are below
/// `max_sigmas` standard deviations of inverse depth.
std::vector<int32_t> JoinCoplanarRegions(const RegionGraph& graph, double max_sigmas);

/// Gives regions below `min_pixels`, as `hosts` has joined them, to the region that most of their
/// border touches, if that is more than half of the border, not small itself, and the mean normals
/// are within `max_angle` [rad]; the others become 0.
void JoinSmallRegions(const RegionGraph& graph, int min_pixels, double max_angle,
                      std::vector<int32_t>* hosts);

/// The regions that JoinSmallRegions took from `before` to `after`, as runs.
std::vector<LooseRun> LooseRuns(const RegionGraph& graph, const std::vector<int32_t>& before,
                                const std::vector<int32_t>& after);

/// The segments that the regions have become: those with one host are one, 0 is none; numbered
/// 0..n-1 by their first pixel in row order.
SegmentImage PaintSegments(const RegionGraph& graph, const std::vector<int32_t>& hosts, int width);

}  // namespace vismap
