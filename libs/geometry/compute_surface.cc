#include "geometry/compute_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "geometry/depth_steps.h"
#include "geometry/fit_normals.h"
#include "geometry/surface_kernels.h"
#include "geometry/window_normals.h"

namespace vismap {
namespace {

/// A plane fitted over a square window of radius r has a slope with a standard deviation of about
/// sqrt(3)/2 σ_w / r^2 per pixel, times the noise's correlation length; the angle of the normal has
/// that times f z. With radius_gain, r = sqrt(radius_gain σ_w z) makes that angle normal_sigma_deg.
SurfaceConstants MakeConstants(const PinholeCamera& camera, const SurfaceOptions& options) {
  const DepthNoiseModel& noise = options.noise;
  const double wanted = options.normal_sigma_deg * std::numbers::pi / 180;
  const double scale = std::max(1.0, camera.width / 640.0);
  const double tangent = std::tan(options.max_incidence_deg * std::numbers::pi / 180);
  const auto f = [](double x) { return static_cast<float>(x); };
  return {.min_depth = f(options.min_depth_m),
          .max_depth = f(options.max_depth_m),
          .axial_base = f(noise.axial_base_m),
          .axial_quadratic = f(noise.axial_quadratic_per_m),
          .axial_offset = f(noise.axial_offset_m),
          .disparity_sigma = f(noise.disparity_step_per_m / std::sqrt(12.0)),
          .radius_gain = f(0.5 * std::sqrt(3.0) * camera.fx * noise.correlation_px / wanted),
          .min_radius = f(options.min_radius_px),
          .max_radius = f(std::min(kMaxReach - 1.0, options.max_radius_px * scale)),
          .ray_x0 = f(-camera.cx / camera.fx),
          .ray_step_x = f(1 / camera.fx),
          .jump_sigmas = f(options.jump_sigmas),
          .max_step_x = f(tangent / camera.fx),
          .max_step_y = f(tangent / camera.fy)};
}

/// Sets the joined bits of row v. Pixels outside the image have no depth.
void JoinRow(const InverseDepth& inverse, const SurfaceConstants& k, int v, SurfaceMap* out) {
  const int width = inverse.w.width(), last = inverse.w.height() - 1;
  const std::vector<float> none(static_cast<size_t>(width), 0.0F);
  const float* w = inverse.w.row(v);
  const float* sigma = inverse.sigma.row(v);
  uint8_t* joined = out->joined.row(v);
  std::vector<float> padded(static_cast<size_t>(width) + 3, 0.0F);  // one 0 before, two after
  std::copy(w, w + width, padded.begin() + 1);
  JoinPairs({.before = padded.data(),
             .p = w,
             .q = padded.data() + 2,
             .after = padded.data() + 3,
             .sigma_p = sigma,
             .sigma_q = sigma + 1},
            k.jump_sigmas, k.max_step_x, kJoinedRight, width - 1, joined);
  if (v == last) return;
  const float* above = v > 0 ? inverse.w.row(v - 1) : none.data();
  const float* second = v + 2 <= last ? inverse.w.row(v + 2) : none.data();
  JoinPairs({.before = above,
             .p = w,
             .q = inverse.w.row(v + 1),
             .after = second,
             .sigma_p = sigma,
             .sigma_q = inverse.sigma.row(v + 1)},
            k.jump_sigmas, k.max_step_y, kJoinedDown, width, joined);
}

void ReachAlongRow(int v, SurfaceMap* out) {
  const int width = out->joined.width();
  std::vector<uint8_t> scratch(2 * static_cast<size_t>(width));
  ReachLeft(out->joined.row(v), out->radius.row(v), width, scratch.data(), out->reach.left.row(v));
  ReachRight(out->joined.row(v), out->radius.row(v), width, scratch.data(),
             out->reach.right.row(v));
}

void ComputeReach(SurfaceMap* out) {
  const int width = out->joined.width(), height = out->joined.height();
  ParallelFor(static_cast<size_t>(height), kSurfaceRowGrain,
              [&](size_t v) { ReachAlongRow(static_cast<int>(v), out); });
  PixelReach& reach = out->reach;
  std::fill_n(reach.up.row(0), width, uint8_t{0});
  std::fill_n(reach.down.row(height - 1), width, uint8_t{0});
  for (int v = 1; v < height; ++v) {
    ReachFromNext(reach.up.row(v - 1), out->joined.row(v - 1), out->radius.row(v), width,
                  reach.up.row(v));
  }
  for (int v = height - 2; v >= 0; --v) {
    ReachFromNext(reach.down.row(v + 1), out->joined.row(v), out->radius.row(v), width,
                  reach.down.row(v));
  }
}

/// A surface whose pixels have no value yet, since the kernels set them all; only `joined`, to
/// which they add bits, starts at 0.
SurfaceMap UnsetSurface(int width, int height) {
  SurfaceMap out;
  for (VectorImage* vectors : {&out.points_C, &out.normals_C}) {
    for (Image<float>* plane : {&vectors->x, &vectors->y, &vectors->z}) {
      *plane = Image<float>::Unset(width, height);
    }
  }
  out.normal_sigma = Image<float>::Unset(width, height);
  out.depth_sigma = Image<float>::Unset(width, height);
  for (Image<uint8_t>* bytes :
       {&out.radius, &out.reach.left, &out.reach.right, &out.reach.up, &out.reach.down}) {
    *bytes = Image<uint8_t>::Unset(width, height);
  }
  out.joined = Image<uint8_t>(width, height);
  return out;
}

}  // namespace

SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options) {
  Require(depth.width() == camera.width && depth.height() == camera.height,
          "a depth image has the size of its camera");
  SurfaceMap out = UnsetSurface(camera.width, camera.height);
  SurfaceConstants constants = MakeConstants(camera, options);
  const auto rows = static_cast<size_t>(camera.height);
  InverseDepth inverse{Image<float>::Unset(camera.width, camera.height),
                       Image<float>::Unset(camera.width, camera.height)};
  ParallelFor(rows, kSurfaceRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    PreparePixels({.depth = depth.row(v),
                   .point_x = out.points_C.x.row(v),
                   .point_y = out.points_C.y.row(v),
                   .point_z = out.points_C.z.row(v),
                   .w = inverse.w.row(v),
                   .sigma = inverse.sigma.row(v),
                   .depth_sigma = out.depth_sigma.row(v),
                   .radius = out.radius.row(v)},
                  constants, static_cast<float>((v - camera.cy) / camera.fy), camera.width);
  });
  constants.jump_sigmas =
      static_cast<float>(JumpSigmas(inverse.w, inverse.sigma, options.jump_sigmas));
  ParallelFor(rows, kSurfaceRowGrain,
              [&](size_t row) { JoinRow(inverse, constants, static_cast<int>(row), &out); });
  ComputeReach(&out);
  if (options.method == NormalMethod::kWindowCovariance) {
    EstimateWindowNormals(options, &out);
  } else {
    FitNormals(inverse, camera, options.noise.correlation_px, &out);
  }
  return out;
}

}  // namespace vismap
