#include "geometry/compute_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "geometry/fit_normals.h"
#include "geometry/window_normals.h"

namespace vismap {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr size_t kRowGrain = 8;

/// The options and the camera, as the kernels want them.
struct Constants {
  float low, high, base, quadratic, offset, step;  ///< depth range and noise model
  float gain, min_radius, max_radius;              ///< see PrepareRow
  float inv_fx, x0;
  float jump, cap_x, cap_y;  ///< see JoinRow
};

/// A square window of radius r knows the slope to about sqrt(3)/2 sigma / r^2 per pixel; the normal
/// errs by that times f z, and both by the noise's correlation length more. `gain` solves for r.
Constants MakeConstants(const PinholeCamera& camera, const SurfaceOptions& options) {
  const DepthNoiseModel& noise = options.noise;
  const double wanted = options.normal_sigma_deg * std::numbers::pi / 180;
  const double scale = std::max(1.0, camera.width / 640.0);
  const double tangent = std::tan(options.max_incidence_deg * std::numbers::pi / 180);
  const auto f = [](double x) { return static_cast<float>(x); };
  return {f(options.min_depth),
          f(options.max_depth),
          f(noise.axial_base),
          f(noise.axial_quadratic),
          f(noise.axial_offset),
          f(noise.disparity_step / std::sqrt(12.0)),
          f(0.5 * std::sqrt(3.0) * camera.fx * noise.correlation / wanted),
          f(options.min_radius),
          f(std::min(31.0, options.max_radius * scale)),
          f(1 / camera.fx),
          f(-camera.cx / camera.fx),
          f(options.jump_sigmas),
          f(tangent / camera.fx),
          f(tangent / camera.fy)};
}

/// One row of everything that depends on a pixel alone.
struct PixelRow {
  const float* depth;
  float *x, *y, *z, *w, *sigma, *depth_sigma;
  uint8_t* radius;
};

void PrepareRow(PixelRow row, Constants k, float ray_y, int width) {
  const float* __restrict depth = row.depth;
  float* __restrict px = row.x, * __restrict py = row.y, * __restrict pz = row.z;
  float* __restrict w = row.w, * __restrict sigma = row.sigma;
  float* __restrict depth_sigma = row.depth_sigma;
  uint8_t* __restrict radius = row.radius;
  for (int u = 0; u < width; ++u) {
    const float d = depth[u];
    const float in = (d >= k.low ? 1.0F : 0.0F) * (d <= k.high ? 1.0F : 0.0F);
    const float z = in > 0 ? d : 1.0F, inv = 1 / z;
    const float past = std::max(z - k.offset, 0.0F);
    const float axial = (k.base + k.quadratic * past * past) * inv * inv;
    const float inverse_sigma = std::sqrt(axial * axial + k.step * k.step);
    const float reach = std::sqrt(k.gain * inverse_sigma * z) + 0.999F;
    const float point_z = in > 0 ? z : kNaN;
    pz[u] = point_z;
    px[u] = point_z * (k.x0 + k.inv_fx * static_cast<float>(u));
    py[u] = point_z * ray_y;
    w[u] = in * inv;
    sigma[u] = in * inverse_sigma;
    depth_sigma[u] = in * inverse_sigma * z * z;
    const float clamped = std::min(std::max(reach, k.min_radius), k.max_radius);
    radius[u] = static_cast<uint8_t>(static_cast<int>(in * clamped));
  }
}

/// Adds `bit` where p[u] and q[u], neighbours, lie on one surface, given the pixels before p
/// and after q in line. `cap` times p is the largest step that the slope of a surface explains.
void JoinPairs(const float* before, const float* p, const float* q, const float* after,
               const float* sigma_p, const float* sigma_q, float jump, float cap, uint8_t bit,
               int count, uint8_t* __restrict out) {
  for (int u = 0; u < count; ++u) {
    const float tolerance = jump * std::max(sigma_p[u], sigma_q[u]);
    const float step = q[u] - p[u], size = std::abs(step);
    const float slope_before = before[u] > 0 ? p[u] - before[u] : 0.0F;
    const float slope_after = after[u] > 0 ? after[u] - q[u] : 0.0F;
    const float bend = std::min(std::abs(step - slope_before), std::abs(step - slope_after));
    const float sloped = size <= cap * p[u] + tolerance ? bend : size;
    const float depth = std::min(p[u], q[u]);  // 0 = one of them has none
    const float excess = (depth > 0 ? 0.0F : size + 1) + std::min(size, sloped) - tolerance;
    out[u] = static_cast<uint8_t>(out[u] + (excess <= 0 ? bit : 0));
  }
}

void JoinRow(const InverseDepth& inverse, const Constants& k, int v, SurfaceMap* out) {
  const int width = inverse.w.width(), last = inverse.w.height() - 1;
  const std::vector<float> none(static_cast<size_t>(width), 0.0F);
  const float* w = inverse.w.row(v);
  const float* sigma = inverse.sigma.row(v);
  uint8_t* joined = out->joined.row(v);
  std::vector<float> padded(static_cast<size_t>(width) + 3, 0.0F);  // one 0 before, two after
  std::copy(w, w + width, padded.begin() + 1);
  JoinPairs(padded.data(), w, padded.data() + 2, padded.data() + 3, sigma, sigma + 1, k.jump,
            k.cap_x, kJoinedRight, width - 1, joined);
  if (v == last) return;
  const float* above = v > 0 ? inverse.w.row(v - 1) : none.data();
  const float* second = v + 2 <= last ? inverse.w.row(v + 2) : none.data();
  JoinPairs(above, w, inverse.w.row(v + 1), second, sigma, inverse.sigma.row(v + 1), k.jump,
            k.cap_y, kJoinedDown, width, joined);
}

void ReachAlongRow(int v, SurfaceMap* out) {
  const int width = out->joined.width();
  const uint8_t* joined = out->joined.row(v);
  const uint8_t* radius = out->radius.row(v);
  int far = 0;
  for (int u = 1; u < width; ++u) {
    far = (joined[u - 1] & kJoinedRight) ? std::min(far + 1, 255) : 0;
    out->reach.left(v, u) = static_cast<uint8_t>(std::min<int>(far, radius[u]));
  }
  far = 0;
  for (int u = width - 2; u >= 0; --u) {
    far = (joined[u] & kJoinedRight) ? std::min(far + 1, 255) : 0;
    out->reach.right(v, u) = static_cast<uint8_t>(std::min<int>(far, radius[u]));
  }
}

/// The reach of a row down (up) its columns from that of the row below (above) it.
void ReachFromNext(const uint8_t* next, const uint8_t* joined, const uint8_t* radius, int width,
                   uint8_t* __restrict out) {
  for (int u = 0; u < width; ++u) {
    const int far = (next[u] + 1) & -((joined[u] & kJoinedDown) / kJoinedDown);  // 0 unless joined
    out[u] = static_cast<uint8_t>(std::min<int>(far, radius[u]));
  }
}

void ComputeReach(SurfaceMap* out) {
  const int width = out->joined.width(), height = out->joined.height();
  ParallelFor(static_cast<size_t>(height), kRowGrain,
              [&](size_t v) { ReachAlongRow(static_cast<int>(v), out); });
  PixelReach& reach = out->reach;
  for (int v = 1; v < height; ++v) {
    ReachFromNext(reach.up.row(v - 1), out->joined.row(v - 1), out->radius.row(v), width,
                  reach.up.row(v));
  }
  for (int v = height - 2; v >= 0; --v) {
    ReachFromNext(reach.down.row(v + 1), out->joined.row(v), out->radius.row(v), width,
                  reach.down.row(v));
  }
}

SurfaceMap EmptySurface(int width, int height) {
  SurfaceMap out;
  for (VectorImage* vectors : {&out.points_C, &out.normals_C}) {
    for (Image<float>* plane : {&vectors->x, &vectors->y, &vectors->z}) {
      *plane = Image<float>(width, height, kNaN);
    }
  }
  out.normal_sigma = Image<float>(width, height, kNaN);
  out.depth_sigma = Image<float>(width, height);
  for (Image<uint8_t>* bytes : {&out.joined, &out.radius, &out.reach.left, &out.reach.right,
                                &out.reach.up, &out.reach.down}) {
    *bytes = Image<uint8_t>(width, height);
  }
  return out;
}

}  // namespace

SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options) {
  Require(depth.width() == camera.width && depth.height() == camera.height,
          "a depth image has the size of its camera");
  SurfaceMap out = EmptySurface(camera.width, camera.height);
  const Constants constants = MakeConstants(camera, options);
  const auto rows = static_cast<size_t>(camera.height);
  InverseDepth inverse{Image<float>(camera.width, camera.height),
                       Image<float>(camera.width, camera.height)};
  ParallelFor(rows, kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    PrepareRow({depth.row(v), out.points_C.x.row(v), out.points_C.y.row(v), out.points_C.z.row(v),
                inverse.w.row(v), inverse.sigma.row(v), out.depth_sigma.row(v), out.radius.row(v)},
               constants, static_cast<float>((v - camera.cy) / camera.fy), camera.width);
  });
  ParallelFor(rows, kRowGrain,
              [&](size_t row) { JoinRow(inverse, constants, static_cast<int>(row), &out); });
  ComputeReach(&out);
  if (options.method == NormalMethod::kWindowCovariance) {
    EstimateWindowNormals(options, &out);
  } else {
    FitNormals(inverse, camera, options.noise.correlation, &out);
  }
  return out;
}

}  // namespace vismap
