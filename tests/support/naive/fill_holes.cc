#include "support/naive/fill_holes.h"

#include <cmath>
#include <optional>

#include "geometry/hole_kernels.h"

namespace vismap::naive {
namespace {

bool HasDepth(float z) { return z > 0 && std::isfinite(z); }
float Inverse(float z) { return HasDepth(z) ? 1 / z : 0.0F; }

/// A direction along a row or a column.
struct Direction {
  int dv, du;
};

/// The inverse depth of a pixel, and how far away it is [px].
struct Found {
  float w;
  int distance;
};

class HoleFiller {
 public:
  HoleFiller(const Image<float>& w, const HoleOptions& options, double sigmas)
      : w_(w), options_(options), sigmas_(sigmas) {}

  /// The inverse depth of pixel (v, u), which has none, filled along its row or its column; 0 when
  /// neither can be done.
  float FillPixel(int v, int u) const {
    for (const bool sloped : {false, true}) {
      const std::optional<Found> along = Fill(v, u, {0, 1}, sloped),
                                 down = Fill(v, u, {1, 0}, sloped);
      if (along && down) return along->distance <= down->distance ? along->w : down->w;
      if (along) return along->w;
      if (down) return down->w;
    }
    return 0;
  }

 private:
  float W(int v, int u) const { return w_.Contains(v, u) ? w_(v, u) : 0.0F; }

  /// The nearest pixel with depth in a direction.
  std::optional<Found> Nearest(int v, int u, Direction to) const {
    for (int k = 1; k <= kMaxHolePx; ++k) {
      if (const float w = W(v + k * to.dv, u + k * to.du); w > 0) return Found{w, k};
    }
    return std::nullopt;
  }

  /// The slope from `side`, which pixel (v, u) has found in a direction, to the farthest pixel with
  /// depth that is at most 5 pixels behind it.
  std::optional<float> SlopeBehind(int v, int u, Direction to, const Found& side) const {
    for (int d = kMaxHolePx + 1; d >= 1; --d) {
      const int k = side.distance + d;
      if (const float w = W(v + k * to.dv, u + k * to.du); w > 0)
        return (w - side.w) / static_cast<float>(d);
    }
    return std::nullopt;
  }

  /// The square of the largest difference of inverse depths of about `w` that is noise.
  float SquaredLimit(float w) const {
    const auto f = [](double x) { return static_cast<float>(x); };
    const DepthNoiseModel& noise = options_.noise;
    const float past = 1 / w - f(noise.axial_offset_m), beyond = past > 0 ? past : 0.0F;
    const float axial =
        (f(noise.axial_base_m) + f(noise.axial_quadratic_per_m) * beyond * beyond) * w * w;
    const float disparity = f(noise.disparity_step_per_m * noise.disparity_step_per_m / 12);
    return f(sigmas_ * sigmas_) * (axial * axial + disparity);
  }

  /// What fills pixel (v, u) from its two sides along a line; `distance` is that from side to side.
  /// `sloped`: they need not be equal within the noise, but have the slopes beside them.
  std::optional<Found> Fill(int v, int u, Direction to, bool sloped) const {
    const Direction back{-to.dv, -to.du};
    const std::optional<Found> a = Nearest(v, u, back), b = Nearest(v, u, to);
    if (!a || !b || a->distance + b->distance > options_.max_px + 1) return std::nullopt;
    const int distance = a->distance + b->distance;
    const float length = static_cast<float>(distance), rise = b->w - a->w;
    const float limit = SquaredLimit((a->w + b->w) * 0.5F);
    if (!sloped && !(rise * rise <= limit)) return std::nullopt;
    if (sloped) {
      const std::optional<float> before = SlopeBehind(v, u, back, *a);
      const std::optional<float> after = SlopeBehind(v, u, to, *b);
      if (!before || !after) return std::nullopt;
      const float bend_before = rise + *before * length, bend_after = rise - *after * length;
      if (!(bend_before * bend_before <= limit && bend_after * bend_after <= limit))
        return std::nullopt;
    }
    return Found{a->w + rise * (static_cast<float>(a->distance) / length), distance};
  }

  const Image<float>& w_;
  const HoleOptions& options_;
  const double sigmas_;
};

}  // namespace

Image<float> FillHoles(const Image<float>& depth, const HoleOptions& options) {
  if (options.max_px <= 0) return depth;
  const double sigmas = HoleSigmas(depth, options);
  Image<float> w = depth;
  for (float& pixel : w.pixels()) pixel = Inverse(pixel);
  for (int pass = 0; pass < 2; ++pass) {
    const Image<float> before = w;
    for (int v = 0; v < w.height(); ++v) {
      for (int u = 0; u < w.width(); ++u) {
        if (before(v, u) == 0) w(v, u) = HoleFiller(before, options, sigmas).FillPixel(v, u);
      }
    }
  }
  Image<float> filled = depth;
  for (size_t i = 0; i < w.size(); ++i) {
    float& z = filled.data()[i];
    if (!HasDepth(z) && w.data()[i] > 0) z = 1 / w.data()[i];
  }
  return filled;
}

}  // namespace vismap::naive
