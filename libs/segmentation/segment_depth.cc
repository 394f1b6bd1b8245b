#include "segmentation/segment_depth.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/require.h"
#include "segmentation/coplanar.h"
#include "segmentation/published.h"
#include "segmentation/regions.h"

namespace vismap {
namespace {

constexpr size_t kRowGrain = 8;
constexpr uint8_t kRim = 1;  ///< edge strength of a pixel beside a depth jump: given back first

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

  /// 0 = no concave fold between the two pixels; otherwise 2..255, growing with its angle.
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

bool BesideJump(const SurfaceMap& surface, int v, int u) {
  const int width = surface.joined.width(), height = surface.joined.height();
  const uint8_t here = surface.joined(v, u);
  if (u + 1 < width && !(here & kJoinedRight) && surface.radius(v, u + 1)) return true;
  if (v + 1 < height && !(here & kJoinedDown) && surface.radius(v + 1, u)) return true;
  if (u > 0 && !(surface.joined(v, u - 1) & kJoinedRight) && surface.radius(v, u - 1)) return true;
  return v > 0 && !(surface.joined(v - 1, u) & kJoinedDown) && surface.radius(v - 1, u);
}

/// Edge strength of every pixel: 0 inside surfaces.
Image<uint8_t> EdgeStrength(const SurfaceMap& surface, const SegmentationOptions& options) {
  const int width = surface.joined.width(), height = surface.joined.height();
  Image<uint8_t> strength(width, height);
  const PixelReach& reach = surface.reach;
  const FoldTest fold(surface, options);
  ParallelFor(static_cast<size_t>(height), kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    const int start = v * width;
    const uint8_t *left = reach.left.row(v), *right = reach.right.row(v);
    const uint8_t *up = reach.up.row(v), *down = reach.down.row(v);
    for (int u = 0; u < width; ++u) {
      if (surface.radius(v, u) == 0) continue;
      const int here = start + u;
      const uint8_t across = fold.Strength(here - left[u], here + right[u]);
      const uint8_t along = fold.Strength(here - width * up[u], here + width * down[u]);
      const uint8_t rim = BesideJump(surface, v, u) ? kRim : uint8_t{0};
      strength(v, u) = std::max({across, along, rim});
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
  const int min_pixels = ScaledPixels(options.min_segment_pixels, camera);
  if (options.method == SegmentationMethod::kPublished) {
    return SegmentAsPublished(surface, min_pixels, options);
  }
  const Image<uint8_t> strength = EdgeStrength(surface, options);
  Image<int32_t> regions = ConnectedRegions(surface, strength);
  DropSmallRegions(ScaledPixels(options.min_seed_pixels, camera), &regions);
  FloodRegions(surface, strength, &regions);
  AddMissedRegions(surface, min_pixels, &regions);
  if (options.coplanar_sigmas > 0) {
    JoinCoplanarRegions(surface, camera, options.coplanar_sigmas, &regions);
  }
  JoinSmallRegions(surface, min_pixels, options.join_angle_deg * std::numbers::pi / 180, &regions);
  DropSmallRegions(min_pixels, &regions);
  return NumberRegions(regions);
}

}  // namespace vismap
