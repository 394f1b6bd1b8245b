#include "segmentation/segment_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "segmentation/published.h"
#include "segmentation/region_graph.h"
#include "segmentation/regions.h"

namespace vismap {
namespace {

constexpr size_t kFoldRowGrain = 8;

/// Measures the concave fold between two pixels, given by their offsets in the image.
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

  /// For MarkFolds: where it marks no fold, Strength is 0.
  int min_square() const { return PackedSquare(min_angle_); }

  /// Edge strength of the fold between pixels a and b: 0 = none, otherwise 2..255, growing with the
  /// angle. A fold counts from concave_angle_deg on if it exceeds the noise of the normals, and
  /// from sharp_angle_deg on in any case. (1 is for pixels beside a depth jump, which the flood
  /// reaches before those on folds.)
  uint8_t Strength(int a, int b) const {
    const float dx = nx_[b] - nx_[a], dy = ny_[b] - ny_[a], dz = nz_[b] - nz_[a];
    const float square = dx * dx + dy * dy + dz * dz;
    if (!(square >= min_angle_ * min_angle_)) return 0;  // flat, or a normal is missing
    const float opening = (px_[b] - px_[a]) * dx + (py_[b] - py_[a]) * dy + (pz_[b] - pz_[a]) * dz;
    if (opening >= 0) return 0;             // convex
    const float chord = std::sqrt(square);  // about the angle
    const float noise = sigmas_ * std::sqrt(sigma_[a] * sigma_[a] + sigma_[b] * sigma_[b]);
    if (chord < std::min(noise, sharp_angle_)) return 0;  // may be noise
    return static_cast<uint8_t>(std::clamp(chord * 127.0F, kBesideJump + 1.0F, 255.0F));
  }

 private:
  const float *px_, *py_, *pz_, *nx_, *ny_, *nz_, *sigma_;
  float min_angle_, sharp_angle_, sigmas_;
};

Image<uint32_t> PackedNormals(const VectorImage& normals) {
  const int width = normals.z.width(), height = normals.z.height();
  Image<uint32_t> packed = Image<uint32_t>::Unset(width, height);
  ParallelFor(static_cast<size_t>(height), kFoldRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    PackNormals(normals.x.row(v), normals.y.row(v), normals.z.row(v), width, packed.row(v));
  });
  return packed;
}

/// Raises the edge strength of a row where there is a fold across or along it. Only the few pixels
/// that MarkFolds marks are tested exactly.
void AddFolds(const Image<uint32_t>& packed_normals, const SurfaceMap& surface,
              const FoldTest& fold, int v, uint8_t* strength) {
  const int width = packed_normals.width();
  const PixelReach& reach = surface.reach;
  std::vector<uint8_t> marks(static_cast<size_t>(width));
  MarkFolds({.normals = packed_normals.row(v),
             .has_depth = surface.radius.row(v),
             .left = reach.left.row(v),
             .right = reach.right.row(v),
             .up = reach.up.row(v),
             .down = reach.down.row(v),
             .stride = width},
            fold.min_square(), width, marks.data());
  for (int u = 0; u < width; ++u) {
    const uint8_t mark = marks[static_cast<size_t>(u)];
    if (mark == 0) continue;
    const int here = v * width + u;
    const auto add = [&](int a, int b) {
      strength[u] = std::max(strength[u], fold.Strength(a, b));
    };
    if (mark & kFoldAcross) add(here - reach.left(v, u), here + reach.right(v, u));
    if (mark & kFoldAlong) add(here - width * reach.up(v, u), here + width * reach.down(v, u));
  }
}

/// Edge strength of every pixel, see SegmentImage::edge_strength.
Image<uint8_t> EdgeStrength(const SurfaceMap& surface, const Image<uint8_t>& links,
                            const SegmentationOptions& options) {
  const int width = links.width(), height = links.height();
  const Image<uint32_t> packed_normals = PackedNormals(surface.normals_C);
  Image<uint8_t> strength = Image<uint8_t>::Unset(width, height);
  const std::vector<uint8_t> no_depth(static_cast<size_t>(width));
  const FoldTest fold(surface, options);
  ParallelFor(static_cast<size_t>(height), kFoldRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    const auto depth_row = [&](int y) {
      return y >= 0 && y < height ? surface.radius.row(y) : no_depth.data();
    };
    static_assert(kBesideJump == 1);  // MarkRim sets flags
    MarkRim({.links = links.row(v),
             .has_depth = depth_row(v),
             .has_depth_above = depth_row(v - 1),
             .has_depth_below = depth_row(v + 1)},
            width, strength.row(v));
    AddFolds(packed_normals, surface, fold, v, strength.row(v));
  });
  return strength;
}

std::vector<int32_t> EachItsOwnHost(const RegionGraph& graph) {
  std::vector<int32_t> hosts(graph.pixels.size());
  std::iota(hosts.begin(), hosts.end(), 0);
  return hosts;
}

/// A number of pixels at 640x480 as one of the camera's image, by its area.
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
  const PixelGrid grid{.has_depth = surface.radius, .links = links, .edge_strength = strength};
  const int min_seed = ScaledPixels(options.min_seed_px, camera);
  Regions regions = ConnectedRegions(grid, min_seed);
  FloodRegions(grid, &regions.image);
  AddMissedRegions(grid, min_seed, &regions);
  const RegionGraph graph = MakeRegionGraph(surface, camera, links, regions);
  const std::vector<int32_t> planes = options.coplanar_sigmas > 0
                                          ? JoinCoplanarRegions(graph, options.coplanar_sigmas)
                                          : EachItsOwnHost(graph);
  const std::vector<int32_t> hosts =
      JoinSmallRegions(graph, planes, min_pixels, options.join_angle_deg * std::numbers::pi / 180);
  SegmentImage image = PaintSegments(graph, hosts, camera.width);
  image.edge_strength = std::move(strength);
  image.loose = LooseRuns(graph, planes, hosts);
  return image;
}

}  // namespace vismap
