#include "geometry/fit_normals.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "geometry/window_moments.h"

namespace vismap {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr size_t kRowGrain = 8;

/// Sums over the horizontal window of every pixel, x counted from that pixel.
struct RowSums {
  Image<float> n, x, xx, w, xw;
};

/// The sums of one pixel's stretch of its row, from `left` before it to `right` after it.
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
  for (int u = 0; u < width; ++u) {
    const int l = reach.left(v, u), r = reach.right(v, u);
    const auto a = static_cast<size_t>(u - l), b = static_cast<size_t>(u + r + 1);
    const double stretch_w = prefix_w[b] - prefix_w[a];
    const float valid = w[u] > 0 ? 1.0F : 0.0F;
    sums->n(v, u) = valid * static_cast<float>(l + r + 1);
    sums->x(v, u) = valid * static_cast<float>((r * (r + 1) - l * (l + 1)) / 2);
    sums->xx(v, u) =
        valid * static_cast<float>((r * (r + 1) * (2 * r + 1) + l * (l + 1) * (2 * l + 1)) / 6);
    sums->w(v, u) = valid * static_cast<float>(stretch_w);
    sums->xw(v, u) = valid * static_cast<float>(prefix_uw[b] - prefix_uw[a] - u * stretch_w);
  }
}

/// What Solve needs besides the moments, for the first pixel of a strip.
struct SolveArgs {
  float fx, fy;
  float ray_x, ray_y;  ///< direction of the first pixel's ray, z = 1
  float sigma_scale;
  const float* sigma;                  ///< of inverse depth
  float *nx, *ny, *nz, *normal_sigma;  ///< out
};

/// Least-squares plane w = a x + b y + c per pixel, turned into a normal and its expected error.
void Solve(const Moments& m, SolveArgs args, int count) {
  float* __restrict nx = args.nx, * __restrict ny = args.ny, * __restrict nz = args.nz;
  float* __restrict normal_sigma = args.normal_sigma;
  const float* __restrict sigma = args.sigma;
  const float fx = args.fx, fy = args.fy, inv_fx = 1 / fx, inv_fy = 1 / fy, y = args.ray_y;
  for (int i = 0; i < count; ++i) {
    const auto u = static_cast<size_t>(i);
    const float inv_n = 1 / std::max(m.n[u], 1.0F);
    const float mx = m.x[u] * inv_n, my = m.y[u] * inv_n, mw = m.w[u] * inv_n;
    const float cxx = m.xx[u] - m.x[u] * mx, cxy = m.xy[u] - m.x[u] * my;
    const float cyy = m.yy[u] - m.y[u] * my;
    const float cxw = m.xw[u] - m.x[u] * mw, cyw = m.yw[u] - m.y[u] * mw;
    const float det = cxx * cyy - cxy * cxy, trace = cxx + cyy;
    // The smaller eigenvalue of the window's shape, about det / trace: two rows of pixels have 1/4.
    const float plane = m.n[u] >= 5 ? det - 0.2F * m.n[u] * trace : 0.0F;
    const float inv_det = 1 / (plane > 0 ? det : 1.0F);
    const float a = (cxw * cyy - cyw * cxy) * inv_det * fx;
    const float b = (cyw * cxx - cxw * cxy) * inv_det * fy;
    const float x = args.ray_x + static_cast<float>(i) * inv_fx;
    const float c = mw - a * (mx * inv_fx + x) - b * (my * inv_fy + y);
    const float inv_length = 1 / std::sqrt(a * a + b * b + c * c + 1e-30F);
    // a x + b y + c is the fitted inverse depth at the pixel: positive unless the fit is nonsense.
    const float good = plane > 0 ? a * x + b * y + c : 0.0F;
    const float error =
        sigma[i] * args.sigma_scale * inv_length * std::sqrt(std::max(trace * inv_det, 0.0F));
    nx[i] = good > 0 ? -a * inv_length : kNaN;
    ny[i] = good > 0 ? -b * inv_length : kNaN;
    nz[i] = good > 0 ? -c * inv_length : kNaN;
    normal_sigma[i] = good > 0 ? error : kNaN;
  }
}

void FitStrip(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
              const RowSums& sums, int v, int u, SurfaceMap* out) {
  const int count = std::min(kMomentStrip, camera.width - u);
  const uint8_t* up = out->reach.up.row(v) + u;
  const uint8_t* down = out->reach.down.row(v) + u;
  const int first = -*std::max_element(up, up + count);
  const int last = *std::max_element(down, down + count);
  Moments moments;
  for (int dy = first; dy <= last; ++dy) {
    const int row = v + dy;
    AddRow({sums.n.row(row) + u, sums.x.row(row) + u, sums.xx.row(row) + u, sums.w.row(row) + u,
            sums.xw.row(row) + u},
           dy < 0 ? up : down, dy, count, &moments);
  }
  const SolveArgs args{static_cast<float>(camera.fx),
                       static_cast<float>(camera.fy),
                       static_cast<float>((u - camera.cx) / camera.fx),
                       static_cast<float>((v - camera.cy) / camera.fy),
                       static_cast<float>(correlation * std::max(camera.fx, camera.fy)),
                       inverse.sigma.row(v) + u,
                       out->normals_C.x.row(v) + u,
                       out->normals_C.y.row(v) + u,
                       out->normals_C.z.row(v) + u,
                       out->normal_sigma.row(v) + u};
  Solve(moments, args, count);
}

}  // namespace

void FitNormals(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
                SurfaceMap* surface) {
  const int width = camera.width, height = camera.height;
  const auto rows = static_cast<size_t>(height);
  RowSums sums;
  for (Image<float>* sum : {&sums.n, &sums.x, &sums.xx, &sums.w, &sums.xw}) {
    *sum = Image<float>(width, height);
  }
  ParallelFor(rows, kRowGrain,
              [&](size_t v) { SumRow(inverse, surface->reach, static_cast<int>(v), &sums); });
  ParallelFor(rows, kRowGrain, [&](size_t v) {
    for (int u = 0; u < width; u += kMomentStrip) {
      FitStrip(inverse, camera, correlation, sums, static_cast<int>(v), u, surface);
    }
  });
}

}  // namespace vismap
