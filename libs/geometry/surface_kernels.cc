#include "geometry/surface_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>

#include "geometry/vector_clones.h"

// All functions here are cloned: GCC 12 does not vectorise ordinary functions in the same file.

namespace vismap {
namespace {
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// One number per pixel of a strip; the compiler splits them into registers of the machine's size.
using Floats = float __attribute__((vector_size(4 * kPlaneStrip)));
using Ints = int32_t __attribute__((vector_size(4 * kPlaneStrip)));
using Bytes = uint8_t __attribute__((vector_size(kPlaneStrip)));
}  // namespace

VISMAP_VECTOR_CLONES void PreparePixels(const PixelRow& row, const SurfaceConstants& constants,
                                        float ray_y, int width) {
  const SurfaceConstants k = constants;
  const float* __restrict depth = row.depth;
  float* __restrict px = row.point_x, * __restrict py = row.point_y, * __restrict pz = row.point_z;
  float* __restrict w = row.w, * __restrict sigma = row.sigma;
  float* __restrict depth_sigma = row.depth_sigma;
  uint8_t* __restrict radius = row.radius;
#pragma GCC ivdep  // no row overlaps another, which GCC cannot prove for so many rows
  for (int u = 0; u < width; ++u) {
    const float d = depth[u];
    const float in = (d >= k.min_depth ? 1.0F : 0.0F) * (d <= k.max_depth ? 1.0F : 0.0F);
    const float z = in > 0 ? d : 1.0F, inv = 1 / z;
    const float past = std::max(z - k.axial_offset, 0.0F);
    const float axial = (k.axial_base + k.axial_quadratic * past * past) * inv * inv;
    const float inverse_sigma = std::sqrt(axial * axial + k.disparity_sigma * k.disparity_sigma);
    const float reach = std::sqrt(k.radius_gain * inverse_sigma * z) + 0.999F;  // rounds up
    const float point_z = in > 0 ? z : kNaN;
    pz[u] = point_z;
    px[u] = point_z * (k.ray_x0 + k.ray_step_x * static_cast<float>(u));
    py[u] = point_z * ray_y;
    w[u] = in * inv;
    sigma[u] = in * inverse_sigma;
    depth_sigma[u] = in * inverse_sigma * z * z;
    const float clamped = std::min(std::max(reach, k.min_radius), k.max_radius);
    radius[u] = static_cast<uint8_t>(static_cast<int>(in * clamped));
  }
}

VISMAP_VECTOR_CLONES void JoinPairs(const PairRow& row, float jump_sigmas, float max_step,
                                    uint8_t bit, int count, uint8_t* __restrict out) {
  const float *before = row.before, *p = row.p, *q = row.q, *after = row.after;
  const float *sigma_p = row.sigma_p, *sigma_q = row.sigma_q;
  for (int u = 0; u < count; ++u) {
    const float tolerance = jump_sigmas * std::max(sigma_p[u], sigma_q[u]);
    const float step = q[u] - p[u], size = std::abs(step);
    const float slope_before = before[u] > 0 ? p[u] - before[u] : 0.0F;
    const float slope_after = after[u] > 0 ? after[u] - q[u] : 0.0F;
    const float bend = std::min(std::abs(step - slope_before), std::abs(step - slope_after));
    const float sloped = size <= max_step * p[u] + tolerance ? bend : size;
    const float depth = std::min(p[u], q[u]);  // 0 = one of them has none
    const float excess = (depth > 0 ? 0.0F : size + 1) + std::min(size, sloped) - tolerance;
    out[u] = static_cast<uint8_t>(out[u] + (excess <= 0 ? bit : 0));
  }
}

VISMAP_VECTOR_CLONES void ReachLeft(const uint8_t* joined, const uint8_t* radius, int width,
                                    uint8_t* scratch, uint8_t* __restrict out) {
  uint8_t* from = scratch;
  uint8_t* to = scratch + width;
  from[0] = 0;
  for (int u = 1; u < width; ++u) from[u] = joined[u - 1] & 1;  // kJoinedRight
  for (int k = 1; k < kMaxReach; k *= 2) {
    const int head = std::min(k, width);
    for (int u = 0; u < head; ++u) to[u] = from[u];
    const uint8_t* __restrict a = from;
    uint8_t* __restrict b = to;
    const auto full = static_cast<uint8_t>(k);
    for (int u = k; u < width; ++u) {
      const uint8_t near = a[u],
                    far = a[u - k];  // both are read always, or the loop does not vectorise
      b[u] = static_cast<uint8_t>(near + (near == full ? far : 0));
    }
    std::swap(from, to);
  }
  const uint8_t* __restrict far = from;
  for (int u = 0; u < width; ++u) out[u] = std::min(far[u], radius[u]);
}

VISMAP_VECTOR_CLONES void ReachRight(const uint8_t* joined, const uint8_t* radius, int width,
                                     uint8_t* scratch, uint8_t* __restrict out) {
  uint8_t* from = scratch;
  uint8_t* to = scratch + width;
  for (int u = 0; u + 1 < width; ++u) from[u] = joined[u] & 1;  // kJoinedRight
  from[width - 1] = 0;
  for (int k = 1; k < kMaxReach; k *= 2) {
    const int body = std::max(width - k, 0);
    const uint8_t* __restrict a = from;
    uint8_t* __restrict b = to;
    const auto full = static_cast<uint8_t>(k);
    for (int u = 0; u < body; ++u) {
      const uint8_t near = a[u], far = a[u + k];
      b[u] = static_cast<uint8_t>(near + (near == full ? far : 0));
    }
    for (int u = body; u < width; ++u) b[u] = a[u];
    std::swap(from, to);
  }
  const uint8_t* __restrict far = from;
  for (int u = 0; u < width; ++u) out[u] = std::min(far[u], radius[u]);
}

VISMAP_VECTOR_CLONES void ReachFromNext(const uint8_t* next, const uint8_t* joined,
                                        const uint8_t* radius, int width, uint8_t* __restrict out) {
  for (int u = 0; u < width; ++u) {
    const auto far = static_cast<uint8_t>(joined[u] & 2 ? next[u] + 1 : 0);  // kJoinedDown
    out[u] = std::min(far, radius[u]);
  }
}

VISMAP_VECTOR_CLONES void SumStretches(const StretchRow& row, int width, const SumsRow& out) {
  const float* __restrict w = row.w;
  const uint8_t* __restrict left = row.left, * __restrict right = row.right;
  const double* __restrict prefix_w = row.prefix_w, * __restrict prefix_uw = row.prefix_uw;
  float* __restrict n = out.n, * __restrict x = out.x, * __restrict xx = out.xx;
  float* __restrict sum_w = out.w, * __restrict sum_xw = out.xw;
#pragma GCC ivdep
  for (int u = 0; u < width; ++u) {
    const int l = left[u], r = right[u], a = u - l, b = u + r + 1;
    const double stretch_w = prefix_w[b] - prefix_w[a];
    const float valid = w[u] > 0 ? 1.0F : 0.0F;
    n[u] = valid * static_cast<float>(l + r + 1);
    // The sums of x and x^2 over [-l, r]: that over 1..r minus (plus) that over 1..l. They are
    // small integers, so that floats are exact.
    x[u] = valid * static_cast<float>((r * (r + 1) - l * (l + 1)) / 2);
    xx[u] = valid * static_cast<float>((r * (r + 1) * (2 * r + 1) + l * (l + 1) * (2 * l + 1)) / 6);
    sum_w[u] = valid * static_cast<float>(stretch_w);
    sum_xw[u] = valid * static_cast<float>(prefix_uw[b] - prefix_uw[a] - u * stretch_w);
  }
}

VISMAP_VECTOR_CLONES void FitPlanes(const PlaneStrip& strip, const NormalRow& out) {
  Bytes up_bytes, down_bytes;
  std::memcpy(&up_bytes, strip.up, sizeof(up_bytes));
  std::memcpy(&down_bytes, strip.down, sizeof(down_bytes));
  const Ints up = __builtin_convertvector(up_bytes, Ints);
  const Ints down = __builtin_convertvector(down_bytes, Ints);

  // Moments of each pixel's window; x and y are counted from that pixel, w = inverse depth.
  Floats n{}, x{}, y{}, xx{}, xy{}, yy{}, w{}, xw{}, yw{};
  for (int dy = -strip.rows_up; dy <= strip.rows_down; ++dy) {
    const Ints in = dy < 0 ? up >= -dy : down >= dy;  // all bits set, or none
    const ptrdiff_t at = static_cast<ptrdiff_t>(dy) * strip.stride;
    Ints rn, rx, rxx, rw, rxw;
    std::memcpy(&rn, strip.sums.n + at, sizeof(rn));
    std::memcpy(&rx, strip.sums.x + at, sizeof(rx));
    std::memcpy(&rxx, strip.sums.xx + at, sizeof(rxx));
    std::memcpy(&rw, strip.sums.w + at, sizeof(rw));
    std::memcpy(&rxw, strip.sums.xw + at, sizeof(rxw));
    const auto row_n = reinterpret_cast<Floats>(rn & in), row_x = reinterpret_cast<Floats>(rx & in);
    const auto row_w = reinterpret_cast<Floats>(rw & in);
    const auto distance = static_cast<float>(dy);
    n += row_n;
    x += row_x;
    y += distance * row_n;
    xx += reinterpret_cast<Floats>(rxx & in);
    xy += distance * row_x;
    yy += distance * (distance * row_n);
    w += row_w;
    xw += reinterpret_cast<Floats>(rxw & in);
    yw += distance * row_w;
  }

  // Copied to plain arrays, since loops over those vectorise.
  struct Moments {
    alignas(64) float n[kPlaneStrip], x[kPlaneStrip], y[kPlaneStrip], xx[kPlaneStrip],
        xy[kPlaneStrip], yy[kPlaneStrip], w[kPlaneStrip], xw[kPlaneStrip], yw[kPlaneStrip];
  } m;
  std::memcpy(m.n, &n, sizeof(n));
  std::memcpy(m.x, &x, sizeof(x));
  std::memcpy(m.y, &y, sizeof(y));
  std::memcpy(m.xx, &xx, sizeof(xx));
  std::memcpy(m.xy, &xy, sizeof(xy));
  std::memcpy(m.yy, &yy, sizeof(yy));
  std::memcpy(m.w, &w, sizeof(w));
  std::memcpy(m.xw, &xw, sizeof(xw));
  std::memcpy(m.yw, &yw, sizeof(yw));
  float* __restrict nx = out.x, * __restrict ny = out.y, * __restrict nz = out.z;
  float* __restrict normal_sigma = out.sigma;
  const float* __restrict sigma = strip.sigma;
  const float fx = strip.fx, fy = strip.fy, inv_fx = 1 / fx, inv_fy = 1 / fy;
  const float first_x = strip.ray_x, ray_y = strip.ray_y, scale = strip.sigma_scale;
  for (int i = 0; i < kPlaneStrip; ++i) {
    const float inv_n = 1 / std::max(m.n[i], 1.0F);
    const float mx = m.x[i] * inv_n, my = m.y[i] * inv_n, mw = m.w[i] * inv_n;
    const float cxx = m.xx[i] - m.x[i] * mx, cxy = m.xy[i] - m.x[i] * my;
    const float cyy = m.yy[i] - m.y[i] * my;
    const float cxw = m.xw[i] - m.x[i] * mw, cyw = m.yw[i] - m.y[i] * mw;
    const float det = cxx * cyy - cxy * cxy, trace = cxx + cyy;
    // det / trace is about the smaller eigenvalue of the window's scatter, n times the variance
    // across its shorter side. Two rows of pixels have a variance of 1/4, one row has 0.
    const float plane = m.n[i] >= 5 ? det - 0.2F * m.n[i] * trace : 0.0F;
    const float inv_det = 1 / (plane > 0 ? det : 1.0F);
    const float a = (cxw * cyy - cyw * cxy) * inv_det * fx;
    const float b = (cyw * cxx - cxw * cxy) * inv_det * fy;
    const float ray_x = first_x + static_cast<float>(i) * inv_fx;
    const float c = mw - a * (mx * inv_fx + ray_x) - b * (my * inv_fy + ray_y);
    const float inv_length = 1 / std::sqrt(a * a + b * b + c * c + 1e-30F);
    // The fitted inverse depth at the pixel; negative when the plane lies behind the camera.
    const float good = plane > 0 ? a * ray_x + b * ray_y + c : 0.0F;
    const float error = sigma[i] * scale * inv_length * std::sqrt(std::max(trace * inv_det, 0.0F));
    nx[i] = good > 0 ? -a * inv_length : kNaN;
    ny[i] = good > 0 ? -b * inv_length : kNaN;
    nz[i] = good > 0 ? -c * inv_length : kNaN;
    normal_sigma[i] = good > 0 ? error : kNaN;
  }
}

}  // namespace vismap
