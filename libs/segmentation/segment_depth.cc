#include "segmentation/segment_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "segmentation/published.h"
#include "segmentation/region_graph.h"
#include "segmentation/regions.h"

namespace vismap {
namespace {

constexpr size_t kRowGrain = 8;

/// Concave folds between pairs of pixels, graded. Pixels are given by their offset in the image.
class FoldTest {
 public:
  FoldTest(const SurfaceMap& surface, const SegmentationOptions& options)
      : px_(surface.points_C.x.data()),
        py_(surface.points_C.y.data()),
        pz_(surface.points_C.z.data()),
        nx_(surface.normals_C.x.data()),
        ny_(surface.normals_C.y.data()),
        nz_(surface.normals_C.z.data()),
        sigma_(surface.normal_sigma.data()),
        min_angle_(static_cast<float>(options.concave_angle_deg * std::numbers::pi / 180)),
        sharp_angle_(static_cast<float>(options.sharp_angle_deg * std::numbers::pi / 180)),
        sigmas_(static_cast<float>(options.concave_sigmas)) {}

  /// For MarkFolds: pixels that it does not mark have no fold.
  int min_square() const { return PackedSquare(min_angle_); }

  /// 0 = no concave fold between the two pixels; otherwise 2..255, growing with its angle (1 is
  /// left to pixels beside a depth jump, which are given back first).
  uint8_t Strength(int a, int b) const {
    const float dx = nx_[b] - nx_[a], dy = ny_[b] - ny_[a], dz = nz_[b] - nz_[a];
    const float square = dx * dx + dy * dy + dz * dz;
    if (!(square >= min_angle_ * min_angle_)) return 0;  // flat, or without a normal
    const float opening = (px_[b] - px_[a]) * dx + (py_[b] - py_[a]) * dy + (pz_[b] - pz_[a]) * dz;
    if (opening >= 0) return 0;             // convex
    const float chord = std::sqrt(square);  // about the angle
    const float noise = sigmas_ * std::sqrt(sigma_[a] * sigma_[a] + sigma_[b] * sigma_[b]);
    if (chord < std::min(noise, sharp_angle_)) return 0;
    return static_cast<uint8_t>(std::clamp(chord * 127.0F, 2.0F, 255.0F));
  }

 private:
  const float *px_, *py_, *pz_, *nx_, *ny_, *nz_, *sigma_;
  float min_angle_, sharp_angle_, sigmas_;
};

/// Edge strength of every pixel: 0 inside surfaces.
Image<uint8_t> EdgeStrength(const SurfaceMap& surface, const Image<uint8_t>& links,
                            const SegmentationOptions& options) {
  const int width = links.width(), height = links.height();
  const auto rows = static_cast<size_t>(height);
  Image<uint32_t> packed = Image<uint32_t>::Unset(width, height);
  ParallelFor(rows, kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    PackNormals(surface.normals_C.x.row(v), surface.normals_C.y.row(v), surface.normals_C.z.row(v),
                width, packed.row(v));
  });
  Image<uint8_t> strength = Image<uint8_t>::Unset(width, height);
  const std::vector<uint8_t> none(static_cast<size_t>(width));
  const PixelReach& reach = surface.reach;
  const FoldTest fold(surface, options);
  ParallelFor(rows, kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    uint8_t* out = strength.row(v);
    MarkRim(links.row(v), v > 0 ? surface.radius.row(v - 1) : none.data(), surface.radius.row(v),
            v + 1 < height ? surface.radius.row(v + 1) : none.data(), width, out);  // kRim = 1
    // Few pixels have normals around them that differ: only those are looked at closely.
    std::vector<uint8_t> marks(static_cast<size_t>(width));
    MarkFolds({packed.row(v), surface.radius.row(v), reach.left.row(v), reach.right.row(v),
               reach.up.row(v), reach.down.row(v), width},
              fold.min_square(), width, marks.data());
    for (int u = 0; u < width; ++u) {
      const uint8_t mark = marks[static_cast<size_t>(u)];
      if (mark == 0) continue;
      const int here = v * width + u;
      if (mark & kFoldAcross) {
        out[u] = std::max(out[u], fold.Strength(here - reach.left(v, u), here + reach.right(v, u)));
      }
      if (mark & kFoldAlong) {
        out[u] = std::max(
            out[u], fold.Strength(here - width * reach.up(v, u), here + width * reach.down(v, u)));
      }
    }
  });
  return strength;
}

int ScaledPixels(int pixels_at_vga, const PinholeCamera& camera) {
  const double area = static_cast<double>(camera.width) * camera.height;
  return std::max(1, static_cast<int>(std::lround(pixels_at_vga * area / (640.0 * 480.0))));
}

}  // namespace

SegmentImage SegmentDepth(const SurfaceMap& surface, const PinholeCamera& camera,
                          const SegmentationOptions& options) {
  Require(surface.joined.width() == camera.width && surface.joined.height() == camera.height,
          "a surface has the size of its camera");
  const int min_pixels = ScaledPixels(options.min_segment_px, camera);
  if (options.method == SegmentationMethod::kPublished) {
    return SegmentAsPublished(surface, min_pixels, options);
  }
  const Image<uint8_t> links = LinkImage(surface.joined);
  Image<uint8_t> strength = EdgeStrength(surface, links, options);
  const int min_seed = ScaledPixels(options.min_seed_px, camera);
  Regions regions = ConnectedRegions(surface.radius, links, strength, min_seed);
  FloodRegions(surface.radius, links, strength, &regions.image);
  AddMissedRegions(surface.radius, links, min_seed, &regions);
  const RegionGraph graph = MakeRegionGraph(surface, camera, links, regions);
  std::vector<int32_t> hosts;
  if (options.coplanar_sigmas > 0) {
    hosts = JoinCoplanarRegions(graph, options.coplanar_sigmas);
  } else {
    hosts.resize(graph.pixels.size());
    std::iota(hosts.begin(), hosts.end(), 0);
  }
  const std::vector<int32_t> before = hosts;
  JoinSmallRegions(graph, min_pixels, options.join_angle_deg * std::numbers::pi / 180, &hosts);
  SegmentImage image = PaintSegments(graph, hosts, camera.width);
  image.ambiguous = std::move(strength);
  image.loose = LooseRuns(graph, before, hosts);
  return image;
}

}  // namespace vismap
