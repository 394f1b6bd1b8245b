#include "geometry/fit_normals.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/parallel.h"
#include "geometry/surface_kernels.h"

namespace vismap {
namespace {

/// Sums over the stretch of its row that each pixel reaches, see SumStretches. The rows are padded
/// with zeros to whole strips.
struct RowSums {
  Image<float> n, x, xx, w, xw;

  SumsRow At(int v, int u) {
    return {.n = n.row(v) + u,
            .x = x.row(v) + u,
            .xx = xx.row(v) + u,
            .w = w.row(v) + u,
            .xw = xw.row(v) + u};
  }
};

void SumRow(const InverseDepth& inverse, const PixelReach& reach, int v, RowSums* sums) {
  const int width = inverse.w.width();
  const float* w = inverse.w.row(v);
  std::vector<double> prefix_w(static_cast<size_t>(width) + 1), prefix_uw(prefix_w.size());
  double sum_w = 0, sum_uw = 0;
  for (int u = 0; u < width; ++u) {
    sum_w += w[u];
    sum_uw += static_cast<double>(u) * w[u];
    prefix_w[static_cast<size_t>(u) + 1] = sum_w;
    prefix_uw[static_cast<size_t>(u) + 1] = sum_uw;
  }
  SumStretches({.w = w,
                .left = reach.left.row(v),
                .right = reach.right.row(v),
                .prefix_w = prefix_w.data(),
                .prefix_uw = prefix_uw.data()},
               width, sums->At(v, 0));
  for (Image<float>* sum : {&sums->n, &sums->x, &sums->xx, &sums->w, &sums->xw})
    std::fill(sum->row(v) + width, sum->row(v) + sum->width(), 0.0F);
}

/// Memory for a strip at the end of a row that has fewer than kPlaneStrip pixels; the others have
/// no window.
struct PaddedStrip {
  std::array<uint8_t, kPlaneStrip> up{}, down{};
  std::array<float, kPlaneStrip> sigma{};
  std::array<float, kPlaneStrip> x{}, y{}, z{}, normal_sigma{};
};

void FitPaddedStrip(PlaneStrip strip, const NormalRow& out, int count) {
  PaddedStrip padded;
  std::copy_n(strip.up, count, padded.up.begin());
  std::copy_n(strip.down, count, padded.down.begin());
  std::copy_n(strip.sigma, count, padded.sigma.begin());
  strip.up = padded.up.data();
  strip.down = padded.down.data();
  strip.sigma = padded.sigma.data();
  FitPlanes(strip, {padded.x.data(), padded.y.data(), padded.z.data(), padded.normal_sigma.data()});
  std::copy_n(padded.x.begin(), count, out.x);
  std::copy_n(padded.y.begin(), count, out.y);
  std::copy_n(padded.z.begin(), count, out.z);
  std::copy_n(padded.normal_sigma.begin(), count, out.sigma);
}

void FitStrip(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
              RowSums* sums, int v, int u, SurfaceMap* out) {
  const int count = std::min(kPlaneStrip, camera.width - u);
  const uint8_t* up = out->reach.up.row(v) + u;
  const uint8_t* down = out->reach.down.row(v) + u;
  const PlaneStrip strip{
      .sums = sums->At(v, u),
      .stride = sums->n.width(),
      .up = up,
      .down = down,
      .rows_up = *std::max_element(up, up + count),
      .rows_down = *std::max_element(down, down + count),
      .sigma = inverse.sigma.row(v) + u,
      .fx = static_cast<float>(camera.fx),
      .fy = static_cast<float>(camera.fy),
      .ray_x = static_cast<float>((u - camera.cx) / camera.fx),
      .ray_y = static_cast<float>((v - camera.cy) / camera.fy),
      .sigma_scale = static_cast<float>(correlation * std::max(camera.fx, camera.fy))};
  const NormalRow normals{.x = out->normals_C.x.row(v) + u,
                          .y = out->normals_C.y.row(v) + u,
                          .z = out->normals_C.z.row(v) + u,
                          .sigma = out->normal_sigma.row(v) + u};
  if (count == kPlaneStrip) {
    FitPlanes(strip, normals);
  } else {
    FitPaddedStrip(strip, normals, count);
  }
}

}  // namespace

void FitNormals(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
                SurfaceMap* surface) {
  const int width = camera.width, height = camera.height;
  const int padded_width = (width + kPlaneStrip - 1) / kPlaneStrip * kPlaneStrip;
  const auto rows = static_cast<size_t>(height);
  RowSums sums;
  for (Image<float>* sum : {&sums.n, &sums.x, &sums.xx, &sums.w, &sums.xw}) {
    *sum = Image<float>::Unset(padded_width, height);
  }
  ParallelFor(rows, kSurfaceRowGrain,
              [&](size_t v) { SumRow(inverse, surface->reach, static_cast<int>(v), &sums); });
  ParallelFor(rows, kSurfaceRowGrain, [&](size_t v) {
    for (int u = 0; u < width; u += kPlaneStrip) {
      FitStrip(inverse, camera, correlation, &sums, static_cast<int>(v), u, surface);
    }
  });
}

}  // namespace vismap
