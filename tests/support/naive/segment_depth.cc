#include "support/naive/segment_depth.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "base/require.h"

namespace vismap::naive {
namespace {

/// The number of the region that each pixel belongs to; 0 = none.
using RegionImage = Image<int32_t>;

struct Pixel {
  int v, u;
};

template <typename Visit>
void ForPixels(const SurfaceMap& surface, const Visit& visit) {
  for (int v = 0; v < surface.joined.height(); ++v) {
    for (int u = 0; u < surface.joined.width(); ++u) visit(Pixel{v, u});
  }
}

/// Calls visit(q, joined) for the neighbours q of pixel p in the image: right, down, left, up.
/// `joined` = p and q lie on one surface.
template <typename Visit>
void ForNeighbors(const SurfaceMap& surface, Pixel p, const Visit& visit) {
  const Image<uint8_t>& joined = surface.joined;
  const auto [v, u] = p;
  if (u + 1 < joined.width()) visit(Pixel{v, u + 1}, (joined(v, u) & kJoinedRight) != 0);
  if (v + 1 < joined.height()) visit(Pixel{v + 1, u}, (joined(v, u) & kJoinedDown) != 0);
  if (u > 0) visit(Pixel{v, u - 1}, (joined(v, u - 1) & kJoinedRight) != 0);
  if (v > 0) visit(Pixel{v - 1, u}, (joined(v - 1, u) & kJoinedDown) != 0);
}

/// 0 = no concave fold between two pixels; otherwise 2..255, growing with its angle.
uint8_t FoldStrength(const SurfaceMap& surface, Pixel a, Pixel b,
                     const SegmentationOptions& options) {
  const auto radians = [](double deg) { return static_cast<float>(deg * std::numbers::pi / 180); };
  const float min_angle = radians(options.concave_angle_deg);
  const VectorImage &points = surface.points_C, &normals = surface.normals_C;
  const float dx = normals.x(b.v, b.u) - normals.x(a.v, a.u);
  const float dy = normals.y(b.v, b.u) - normals.y(a.v, a.u);
  const float dz = normals.z(b.v, b.u) - normals.z(a.v, a.u);
  const float square = dx * dx + dy * dy + dz * dz;
  if (!(square >= min_angle * min_angle)) return 0;  // flat, or a normal is missing
  const float opening = (points.x(b.v, b.u) - points.x(a.v, a.u)) * dx +
                        (points.y(b.v, b.u) - points.y(a.v, a.u)) * dy +
                        (points.z(b.v, b.u) - points.z(a.v, a.u)) * dz;
  if (opening >= 0) return 0;             // convex
  const float chord = std::sqrt(square);  // about the angle
  const float sigma_a = surface.normal_sigma(a.v, a.u), sigma_b = surface.normal_sigma(b.v, b.u);
  const float noise =
      static_cast<float>(options.concave_sigmas) * std::sqrt(sigma_a * sigma_a + sigma_b * sigma_b);
  if (chord < std::min(noise, radians(options.sharp_angle_deg))) return 0;  // may be noise
  return static_cast<uint8_t>(std::clamp(chord * 127.0F, 2.0F, 255.0F));
}

/// 0 inside a surface, 1 beside a depth jump, more on a fold.
uint8_t EdgeStrength(const SurfaceMap& surface, Pixel p, const SegmentationOptions& options) {
  const auto [v, u] = p;
  if (surface.radius(v, u) == 0) return 0;
  const PixelReach& reach = surface.reach;
  uint8_t strength = std::max(
      FoldStrength(surface, {v, u - reach.left(v, u)}, {v, u + reach.right(v, u)}, options),
      FoldStrength(surface, {v - reach.up(v, u), u}, {v + reach.down(v, u), u}, options));
  ForNeighbors(surface, p, [&](Pixel q, bool joined) {
    if (!joined && surface.radius(q.v, q.u) != 0) strength = std::max(strength, uint8_t{1});
  });
  return strength;
}

/// The connected regions of joined pixels for which keep(pixel) is true, numbered 1, 2, ... by
/// their first pixel in row order.
template <typename Keep>
RegionImage Connect(const SurfaceMap& surface, const Keep& keep) {
  RegionImage regions(surface.joined.width(), surface.joined.height());
  int32_t count = 0;
  ForPixels(surface, [&](Pixel first) {
    if (regions(first.v, first.u) != 0 || !keep(first)) return;
    regions(first.v, first.u) = ++count;
    std::vector<Pixel> open{first};
    for (size_t next = 0; next < open.size(); ++next) {  // `open` grows
      ForNeighbors(surface, Pixel(open[next]), [&](Pixel q, bool joined) {
        if (!joined || regions(q.v, q.u) != 0 || !keep(q)) return;
        regions(q.v, q.u) = count;
        open.push_back(q);
      });
    }
  });
  return regions;
}

void DropSmallRegions(int min_pixels, RegionImage* regions) {
  std::map<int32_t, int> pixels;
  for (const int32_t region : regions->pixels()) ++pixels[region];
  for (int32_t& region : regions->pixels()) {
    if (pixels[region] < min_pixels) region = 0;
  }
}

/// Grows the regions along joined pixels to all pixels that they can reach. A pixel waits in the
/// queue of the strongest edge on the way to it, so that all pixels behind weaker edges come first.
/// Within a queue the order is first in, first out.
void FloodRegions(const SurfaceMap& surface, const Image<uint8_t>& strength, RegionImage* regions) {
  std::array<std::vector<Pixel>, 256> queues;
  ForPixels(surface, [&](Pixel p) {
    if ((*regions)(p.v, p.u) != 0) queues[0].push_back(p);
  });
  for (size_t level = 0; level < queues.size(); ++level) {
    for (size_t next = 0; next < queues[level].size(); ++next) {  // the queue grows
      const Pixel p = queues[level][next];
      ForNeighbors(surface, p, [&](Pixel q, bool joined) {
        if (!joined || (*regions)(q.v, q.u) != 0) return;
        (*regions)(q.v, q.u) = (*regions)(p.v, p.u);
        queues[std::max<size_t>(level, strength(q.v, q.u))].push_back(q);
      });
    }
  }
}

/// Adds the connected regions of pixels that no region reached, with the next numbers.
void AddMissedRegions(const SurfaceMap& surface, int min_pixels, RegionImage* regions) {
  RegionImage missed = Connect(
      surface, [&](Pixel p) { return surface.radius(p.v, p.u) != 0 && (*regions)(p.v, p.u) == 0; });
  DropSmallRegions(min_pixels, &missed);
  const int32_t used = *std::max_element(regions->pixels().begin(), regions->pixels().end());
  for (size_t i = 0; i < missed.size(); ++i) {
    if (missed.data()[i] != 0) regions->data()[i] = used + missed.data()[i];
  }
}

/// Sums over the pixels of a region, with w = inverse depth and a = (x, y, 1), the ray through the
/// pixel. A plane is w = k . a.
struct PlaneMoments {
  Eigen::Matrix3d aa = Eigen::Matrix3d::Zero();
  Eigen::Vector3d aw = Eigen::Vector3d::Zero();
  double ww = 0, variance = 0;

  double count() const { return aa(2, 2); }
  Eigen::Vector3d Plane() const { return aa.ldlt().solve(aw); }
  double MeanError(const Eigen::Vector3d& k) const { return (aw(2) - k.dot(aa.col(2))) / count(); }
  double MeanSquaredError(const Eigen::Vector3d& k) const {
    return std::max(0.0, (ww - 2 * k.dot(aw) + k.dot(aa * k)) / count());
  }
  double Variance() const { return variance / count(); }
};

/// One region.
struct Region {
  PlaneMoments moments;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // summed
  int pixels = 0;
  int border = 0;                    // number of joined pairs of pixels with other regions
  std::map<int32_t, int> neighbors;  // the same for each other region
};

std::map<int32_t, Region> Measure(const SurfaceMap& surface, const PinholeCamera& camera,
                                  const RegionImage& regions) {
  std::map<int32_t, Region> measured;
  ForPixels(surface, [&](Pixel p) {
    const int32_t number = regions(p.v, p.u);
    if (number == 0) return;
    Region& region = measured[number];
    const double w = 1.0 / surface.points_C.z(p.v, p.u);
    const double sigma = surface.depth_sigma(p.v, p.u) * w * w;
    const Eigen::Vector3d a((p.u - camera.cx) / camera.fx, (p.v - camera.cy) / camera.fy, 1);
    region.moments.aa += a * a.transpose();
    region.moments.aw += w * a;
    region.moments.ww += w * w;
    region.moments.variance += sigma * sigma;
    ++region.pixels;
    if (surface.normals_C.valid(p.v, p.u))
      region.normal += surface.normals_C.at(p.v, p.u).cast<double>();
    ForNeighbors(surface, p, [&](Pixel q, bool joined) {
      const int32_t other = regions(q.v, q.u);
      if (!joined || other == number || other == 0) return;
      ++region.border;
      ++region.neighbors[other];
    });
  });
  return measured;
}

/// Numbers of the regions, the largest first.
std::vector<int32_t> LargestFirst(const std::map<int32_t, Region>& regions) {
  std::vector<int32_t> order;
  for (const auto& [number, region] : regions) order.push_back(number);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    return regions.at(a).pixels > regions.at(b).pixels;
  });
  return order;
}

/// Whether a region lies on a plane within the noise.
bool LiesOn(const Eigen::Vector3d& plane, const PlaneMoments& part, double max_sigmas) {
  const double limit = max_sigmas * max_sigmas * part.Variance();
  const double mean = part.MeanError(plane);
  return mean * mean < 0.25 * limit && part.MeanSquaredError(plane) < limit;
}

/// From the largest region down, joins to each the neighbours that lie on its plane.
void JoinCoplanarRegions(const SurfaceMap& surface, const PinholeCamera& camera, double max_sigmas,
                         RegionImage* regions) {
  const std::map<int32_t, Region> measured = Measure(surface, camera, *regions);
  std::map<int32_t, int32_t> host{{0, 0}};
  for (const int32_t root : LargestFirst(measured)) {
    if (!host.try_emplace(root, root).second) continue;  // joined to a larger region before
    PlaneMoments whole = measured.at(root).moments;
    if (whole.count() < 3) continue;  // too few pixels for a plane
    Eigen::Vector3d plane = whole.Plane();
    if (whole.MeanSquaredError(plane) > max_sigmas * max_sigmas * whole.Variance()) continue;
    std::vector<int32_t> open;
    const auto open_neighbors = [&](int32_t number) {
      for (const auto& [other, pairs] : measured.at(number).neighbors) open.push_back(other);
    };
    open_neighbors(root);
    for (size_t next = 0; next < open.size(); ++next) {  // `open` grows
      const int32_t other = open[next];
      const PlaneMoments& part = measured.at(other).moments;
      if (host.contains(other) || !LiesOn(plane, part, max_sigmas)) continue;
      host[other] = root;
      whole.aa += part.aa;
      whole.aw += part.aw;
      whole.ww += part.ww;
      whole.variance += part.variance;
      plane = whole.Plane();
      open_neighbors(other);
    }
  }
  for (int32_t& region : regions->pixels()) region = host.at(region);
}

/// The large region that a small one is joined to: it has more than half of the small one's border
/// and a similar normal; 0 = none.
int32_t HostOf(const std::map<int32_t, Region>& measured, const Region& small, int min_pixels,
               double max_angle) {
  int32_t host = 0;
  int most = small.border / 2;
  for (const auto& [neighbor, pairs] : small.neighbors) {
    if (pairs <= most || measured.at(neighbor).pixels < min_pixels) continue;
    host = neighbor;
    most = pairs;
  }
  if (host == 0) return 0;
  const Eigen::Vector3d& normal = measured.at(host).normal;
  const double limit = std::cos(max_angle) * normal.norm() * small.normal.norm();
  return normal.dot(small.normal) >= limit ? host : 0;
}

/// Joins small regions to their hosts; those without one become 0.
void JoinSmallRegions(const SurfaceMap& surface, const PinholeCamera& camera, int min_pixels,
                      double max_angle, RegionImage* regions) {
  const std::map<int32_t, Region> measured = Measure(surface, camera, *regions);
  std::map<int32_t, int32_t> becomes{{0, 0}};
  for (const auto& [number, region] : measured) {
    becomes[number] =
        region.pixels >= min_pixels ? number : HostOf(measured, region, min_pixels, max_angle);
  }
  for (int32_t& region : regions->pixels()) region = becomes.at(region);
}

/// The runs of pixels whose region changed; a region before is one piece.
std::vector<LooseRun> LooseRuns(const RegionImage& before, const RegionImage& after) {
  std::vector<LooseRun> loose;
  std::map<int32_t, int32_t> number;
  for (int v = 0; v < before.height(); ++v) {
    for (int u = 0; u < before.width(); ++u) {
      if (before(v, u) == after(v, u)) continue;
      const auto next = static_cast<int32_t>(number.size());
      const int32_t piece = number.try_emplace(before(v, u), next).first->second;
      const bool goes_on = !loose.empty() && loose.back().v == v && loose.back().end == u &&
                           loose.back().piece == piece;
      if (!goes_on) loose.push_back({v, u, u, piece});
      ++loose.back().end;
    }
  }
  return loose;
}

SegmentImage NumberRegions(const RegionImage& regions) {
  SegmentImage image{Image<SegmentIndex>(regions.width(), regions.height(), SegmentIndex::kNone),
                     0};
  std::map<int32_t, SegmentIndex> index{{0, SegmentIndex::kNone}};
  for (size_t i = 0; i < regions.size(); ++i) {
    const auto next = static_cast<SegmentIndex>(image.segment_count);
    const auto [found, is_new] = index.try_emplace(regions.data()[i], next);
    if (is_new) ++image.segment_count;
    image.index.data()[i] = found->second;
  }
  return image;
}

int ScaledPixels(int pixels_at_vga, const PinholeCamera& camera) {
  const double area = static_cast<double>(camera.width) * camera.height;
  return std::max(1, static_cast<int>(std::lround(pixels_at_vga * area / (640.0 * 480.0))));
}

}  // namespace

SegmentImage SegmentDepth(const SurfaceMap& surface, const PinholeCamera& camera,
                          const SegmentationOptions& options) {
  Require(options.method == SegmentationMethod::kNoiseScaled,
          "the naive segmentation has the method kNoiseScaled only");
  const int min_pixels = ScaledPixels(options.min_segment_px, camera);
  Image<uint8_t> strength(camera.width, camera.height);
  ForPixels(surface, [&](Pixel p) { strength(p.v, p.u) = EdgeStrength(surface, p, options); });
  RegionImage regions = Connect(
      surface, [&](Pixel p) { return surface.radius(p.v, p.u) != 0 && strength(p.v, p.u) == 0; });
  const int min_seed = ScaledPixels(options.min_seed_px, camera);
  DropSmallRegions(min_seed, &regions);
  FloodRegions(surface, strength, &regions);
  AddMissedRegions(surface, min_seed, &regions);
  if (options.coplanar_sigmas > 0)
    JoinCoplanarRegions(surface, camera, options.coplanar_sigmas, &regions);
  const RegionImage before = regions;
  JoinSmallRegions(surface, camera, min_pixels, options.join_angle_deg * std::numbers::pi / 180,
                   &regions);
  SegmentImage image = NumberRegions(regions);
  image.edge_strength = std::move(strength);
  image.loose = LooseRuns(before, regions);
  return image;
}

}  // namespace vismap::naive
