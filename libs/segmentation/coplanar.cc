#include "segmentation/coplanar.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

namespace vismap {
namespace {

/// Sums over a region's pixels of inverse depth w and a = (x, y, 1), where a plane is w = k . a.
struct PlaneMoments {
  Eigen::Matrix3d aa = Eigen::Matrix3d::Zero();
  Eigen::Vector3d aw = Eigen::Vector3d::Zero();
  double ww = 0;
  double variance = 0;  ///< expected variance of w, summed

  double count() const { return aa(2, 2); }
  void Add(const PlaneMoments& other) {
    aa += other.aa;
    aw += other.aw;
    ww += other.ww;
    variance += other.variance;
  }
  Eigen::Vector3d Plane() const { return aa.ldlt().solve(aw); }
  double MeanError(const Eigen::Vector3d& k) const { return (aw(2) - k.dot(aa.col(2))) / count(); }
  double MeanSquaredError(const Eigen::Vector3d& k) const {
    return std::max(0.0, (ww - 2 * k.dot(aw) + k.dot(aa * k)) / count());
  }
};

std::vector<PlaneMoments> Measure(const SurfaceMap& surface, const PinholeCamera& camera,
                                  const RegionImage& regions, size_t count) {
  std::vector<PlaneMoments> moments(count);
  for (int v = 0; v < regions.height(); ++v) {
    const double y = (v - camera.cy) / camera.fy;
    for (int u = 0; u < regions.width(); ++u) {
      const int32_t region = regions(v, u);
      if (region == 0) continue;
      const double w = 1.0 / surface.points_C.z(v, u), x = (u - camera.cx) / camera.fx;
      const double sigma = surface.depth_sigma(v, u) * w * w;
      PlaneMoments& m = moments[static_cast<size_t>(region)];
      m.aa(0, 0) += x * x;
      m.aa(0, 1) += x * y;
      m.aa(1, 1) += y * y;
      m.aa(0, 2) += x;
      m.aa(1, 2) += y;
      m.aa(2, 2) += 1;
      m.aw += w * Eigen::Vector3d(x, y, 1);
      m.ww += w * w;
      m.variance += sigma * sigma;
    }
  }
  for (PlaneMoments& m : moments) {
    m.aa.triangularView<Eigen::StrictlyLower>() = m.aa.transpose();
  }
  return moments;
}

/// For each region the regions it is joined with, ascending.
std::vector<std::vector<int32_t>> Neighbors(const SurfaceMap& surface, const RegionImage& regions,
                                            size_t count) {
  std::vector<std::vector<int32_t>> neighbors(count);
  const int width = regions.width(), height = regions.height();
  const auto meet = [&](int32_t a, int32_t b) {
    if (a == b || a == 0 || b == 0) return;
    auto& known = neighbors[static_cast<size_t>(a)];
    if (!known.empty() && known.back() == b) return;  // borders are runs of the same pair
    known.push_back(b);
    neighbors[static_cast<size_t>(b)].push_back(a);
  };
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const uint8_t joined = surface.joined(v, u);
      if (joined & kJoinedRight) meet(regions(v, u), regions(v, u + 1));
      if (joined & kJoinedDown) meet(regions(v, u), regions(v + 1, u));
    }
  }
  for (auto& list : neighbors) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbors;
}

/// Whether `part` lies on the plane of `whole` within the noise.
bool LiesOn(const Eigen::Vector3d& plane, const PlaneMoments& part, double max_sigmas) {
  const double variance = part.variance / part.count();
  const double limit = max_sigmas * max_sigmas * variance;
  const double mean = part.MeanError(plane);
  return mean * mean < 0.25 * limit && part.MeanSquaredError(plane) < limit;
}

}  // namespace

void JoinCoplanarRegions(const SurfaceMap& surface, const PinholeCamera& camera, double max_sigmas,
                         RegionImage* regions) {
  const auto& pixels = regions->pixels();
  const size_t count = static_cast<size_t>(*std::max_element(pixels.begin(), pixels.end())) + 1;
  std::vector<PlaneMoments> moments = Measure(surface, camera, *regions, count);
  const auto neighbors = Neighbors(surface, *regions, count);
  std::vector<int32_t> order(count - 1);
  std::iota(order.begin(), order.end(), 1);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    return moments[static_cast<size_t>(a)].count() > moments[static_cast<size_t>(b)].count();
  });
  std::vector<int32_t> host(count, 0);
  for (const int32_t root : order) {
    PlaneMoments& whole = moments[static_cast<size_t>(root)];
    if (host[static_cast<size_t>(root)]) continue;
    host[static_cast<size_t>(root)] = root;
    if (whole.count() < 3) continue;
    Eigen::Vector3d plane = whole.Plane();
    if (whole.MeanSquaredError(plane) > max_sigmas * max_sigmas * whole.variance / whole.count()) {
      continue;  // not a plane itself
    }
    std::vector<int32_t> open = neighbors[static_cast<size_t>(root)];
    for (size_t next = 0; next < open.size(); ++next) {  // `open` grows
      const auto other = static_cast<size_t>(open[next]);
      if (host[other] || moments[other].count() == 0) continue;
      if (!LiesOn(plane, moments[other], max_sigmas)) continue;
      host[other] = root;
      whole.Add(moments[other]);
      plane = whole.Plane();
      open.insert(open.end(), neighbors[other].begin(), neighbors[other].end());
    }
  }
  for (int32_t& region : regions->pixels()) region = host[static_cast<size_t>(region)];
}

}  // namespace vismap
