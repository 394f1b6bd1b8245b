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

/// How far pixels see along each axis without crossing a depth jump, at most their radius.
struct Reach {
  Image<uint8_t> left, right, up, down;
};

Reach ComputeReach(const SurfaceMap& surface) {
  const int width = surface.joined.width(), height = surface.joined.height();
  const Image<uint8_t> none(width, height);
  Reach reach{none, none, none, none};
  for (int v = 0; v < height; ++v) {
    const uint8_t* joined = surface.joined.row(v);
    const uint8_t* radius = surface.radius.row(v);
    int far = 0;
    for (int u = 1; u < width; ++u) {
      far = (joined[u - 1] & kJoinedRight) ? std::min(far + 1, 255) : 0;
      reach.left(v, u) = static_cast<uint8_t>(std::min<int>(far, radius[u]));
    }
    far = 0;
    for (int u = width - 2; u >= 0; --u) {
      far = (joined[u] & kJoinedRight) ? std::min(far + 1, 255) : 0;
      reach.right(v, u) = static_cast<uint8_t>(std::min<int>(far, radius[u]));
    }
    if (v == 0) continue;
    const uint8_t* above = surface.joined.row(v - 1);
    for (int u = 0; u < width; ++u) {
      const int steps = (above[u] & kJoinedDown) ? reach.up(v - 1, u) + 1 : 0;
      reach.up(v, u) = static_cast<uint8_t>(std::min<int>(steps, radius[u]));
    }
  }
  for (int v = height - 2; v >= 0; --v) {
    const uint8_t* joined = surface.joined.row(v);
    for (int u = 0; u < width; ++u) {
      const int steps = (joined[u] & kJoinedDown) ? reach.down(v + 1, u) + 1 : 0;
      reach.down(v, u) = static_cast<uint8_t>(std::min<int>(steps, surface.radius(v, u)));
    }
  }
  return reach;
}

/// Concave folds between pairs of pixels, graded.
class FoldTest {
 public:
  FoldTest(const SurfaceMap& surface, const SegmentationOptions& options)
      : points_(surface.points_C),
        normals_(surface.normals_C),
        sigma_(surface.normal_sigma),
        min_angle_(static_cast<float>(options.concave_angle_deg * std::numbers::pi / 180)),
        sharp_angle_(static_cast<float>(options.sharp_angle_deg * std::numbers::pi / 180)),
        sigmas_(static_cast<float>(options.concave_sigmas)) {}

  /// 0 = no concave fold between the two pixels; otherwise 2..255, growing with its angle.
  uint8_t Strength(int v, int u, int v2, int u2) const {
    const float nx = normals_.x(v, u), ny = normals_.y(v, u), nz = normals_.z(v, u);
    const float mx = normals_.x(v2, u2), my = normals_.y(v2, u2), mz = normals_.z(v2, u2);
    const float opening = (points_.x(v2, u2) - points_.x(v, u)) * (mx - nx) +
                          (points_.y(v2, u2) - points_.y(v, u)) * (my - ny) +
                          (points_.z(v2, u2) - points_.z(v, u)) * (mz - nz);
    if (!(opening < 0)) return 0;  // convex, flat, or without a normal
    const float dx = mx - nx, dy = my - ny, dz = mz - nz;
    const float chord = std::sqrt(dx * dx + dy * dy + dz * dz);  // about the angle
    const float a = sigma_(v, u), b = sigma_(v2, u2);
    const float noise = std::min(sigmas_ * std::sqrt(a * a + b * b), sharp_angle_);
    if (chord < std::max(min_angle_, noise)) return 0;
    return static_cast<uint8_t>(std::clamp(chord * 127.0F, 2.0F, 255.0F));
  }

 private:
  const VectorImage& points_;
  const VectorImage& normals_;
  const Image<float>& sigma_;
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
  const Reach reach = ComputeReach(surface);
  const FoldTest fold(surface, options);
  ParallelFor(static_cast<size_t>(height), kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < width; ++u) {
      if (surface.radius(v, u) == 0) continue;
      const uint8_t across = fold.Strength(v, u - reach.left(v, u), v, u + reach.right(v, u));
      const uint8_t along = fold.Strength(v - reach.up(v, u), u, v + reach.down(v, u), u);
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
