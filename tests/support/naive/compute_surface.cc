#include "support/naive/compute_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/require.h"
#include "geometry/depth_steps.h"

namespace vismap::naive {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Inverse depth [1/m] and its deviation; 0 = no return.
struct InverseDepth {
  Image<float> w, sigma;

  float W(int v, int u) const { return w.Contains(v, u) ? w(v, u) : 0.0F; }
};

float F(double x) { return static_cast<float>(x); }

float InverseSigma(float z, const DepthNoiseModel& noise) {
  const float inverse = 1 / z, past = std::max(z - F(noise.axial_offset_m), 0.0F);
  const float axial =
      (F(noise.axial_base_m) + F(noise.axial_quadratic_per_m) * past * past) * inverse * inverse;
  const float step = F(noise.disparity_step_per_m / std::sqrt(12.0));
  return std::sqrt(axial * axial + step * step);
}

/// The radius of the window with which the normal has the wanted standard deviation [px].
uint8_t Radius(float z, float sigma, const PinholeCamera& camera, const SurfaceOptions& options) {
  const double wanted = options.normal_sigma_deg * std::numbers::pi / 180;
  const float gain = F(0.5 * std::sqrt(3.0) * camera.fx * options.noise.correlation_px / wanted);
  const float most = F(std::min(31.0, options.max_radius_px * std::max(1.0, camera.width / 640.0)));
  const float radius = std::sqrt(gain * sigma * z) + 0.999F;  // rounds up
  return static_cast<uint8_t>(std::clamp(radius, F(options.min_radius_px), most));
}

void BackProject(int v, int u, float z, const PinholeCamera& camera, const SurfaceOptions& options,
                 InverseDepth* inverse, SurfaceMap* out) {
  if (!(z >= F(options.min_depth_m) && z <= F(options.max_depth_m))) {
    out->points_C.x(v, u) = out->points_C.y(v, u) = out->points_C.z(v, u) = kNaN;
    return;
  }
  const float sigma = InverseSigma(z, options.noise);
  out->points_C.x(v, u) =
      z * (F(-camera.cx / camera.fx) + F(1 / camera.fx) * static_cast<float>(u));
  out->points_C.y(v, u) = z * F((v - camera.cy) / camera.fy);
  out->points_C.z(v, u) = z;
  out->depth_sigma(v, u) = sigma * z * z;
  out->radius(v, u) = Radius(z, sigma, camera, options);
  inverse->w(v, u) = 1 / z;
  inverse->sigma(v, u) = sigma;
}

/// Whether pixel (v, u) lies on one surface with its neighbour (v + dv, u + du): their inverse
/// depths are equal within the noise, or have the slope that the surface has before or after them.
bool Joined(const InverseDepth& inverse, int v, int u, int dv, int du, float jump_sigmas,
            float max_step) {
  const float p = inverse.W(v, u), q = inverse.W(v + dv, u + du);
  if (p == 0 || q == 0) return false;
  const float tolerance =
      jump_sigmas * std::max(inverse.sigma(v, u), inverse.sigma(v + dv, u + du));
  const float before = inverse.W(v - dv, u - du), after = inverse.W(v + 2 * dv, u + 2 * du);
  const float step = q - p, size = std::abs(step);
  if (size - tolerance <= 0) return true;
  if (size > max_step * p + tolerance) return false;  // steeper than any visible surface
  const float slope_before = before > 0 ? p - before : 0.0F;
  const float slope_after = after > 0 ? after - q : 0.0F;
  const float bend = std::min(std::abs(step - slope_before), std::abs(step - slope_after));
  return bend - tolerance <= 0;
}

/// How many pixels (v, u) reaches in direction (dv, du), at most its radius.
uint8_t Reach(const SurfaceMap& surface, int v, int u, int dv, int du) {
  const uint8_t bit = dv == 0 ? kJoinedRight : kJoinedDown;
  const int most = surface.radius(v, u);
  int steps = 0;
  while (steps < most) {
    const int from_v = v + (dv < 0 ? dv : 0),
              from_u = u + (du < 0 ? du : 0);  // of the pair's first pixel
    if (!surface.joined.Contains(from_v, from_u) || !(surface.joined(from_v, from_u) & bit)) break;
    v += dv;
    u += du;
    ++steps;
  }
  return static_cast<uint8_t>(steps);
}

/// Sums over a pixel's window; x and y are counted from that pixel. Sums without w are whole
/// numbers and exact in float.
struct Moments {
  float n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  double w = 0, xw = 0, yw = 0;
};

Moments SumWindow(const InverseDepth& inverse, const SurfaceMap& surface, int v, int u) {
  Moments m;
  const PixelReach& reach = surface.reach;
  for (int y = -reach.up(v, u); y <= reach.down(v, u); ++y) {
    for (int x = -reach.left(v + y, u); x <= reach.right(v + y, u); ++x) {
      const float fx = static_cast<float>(x), fy = static_cast<float>(y);
      const double w = inverse.w(v + y, u + x);
      m.n += 1;
      m.x += fx;
      m.y += fy;
      m.xx += fx * fx;
      m.xy += fx * fy;
      m.yy += fy * fy;
      m.w += w;
      m.xw += x * w;
      m.yw += y * w;
    }
  }
  return m;
}

/// Whether a window is wide enough for a plane. Computed in float like the fast one, so that both
/// decide alike at the limit.
bool DefinesPlane(const Moments& m) {
  const float inv_n = 1 / std::max(m.n, 1.0F), mx = m.x * inv_n, my = m.y * inv_n;
  const float cxx = m.xx - m.x * mx, cxy = m.xy - m.x * my, cyy = m.yy - m.y * my;
  return m.n >= 5 && cxx * cyy - cxy * cxy - 0.2F * m.n * (cxx + cyy) > 0;
}

/// Sets the normal of the plane w = a r_x + b r_y + c through the window of pixel (v, u), r = the
/// ray through a pixel.
void FitNormal(const Moments& m, const PinholeCamera& camera, double sigma, double correlation,
               int v, int u, SurfaceMap* out) {
  if (!DefinesPlane(m)) return;
  const double n = m.n, mx = m.x / n, my = m.y / n, mw = m.w / n;
  const double cxx = m.xx - m.x * mx, cxy = m.xy - m.x * my, cyy = m.yy - m.y * my;
  const double cxw = m.xw - m.x * mw, cyw = m.yw - m.y * mw;
  const double det = cxx * cyy - cxy * cxy, trace = cxx + cyy;
  const double a = (cxw * cyy - cyw * cxy) / det * camera.fx;
  const double b = (cyw * cxx - cxw * cxy) / det * camera.fy;
  const double ray_x = (u - camera.cx) / camera.fx, ray_y = (v - camera.cy) / camera.fy;
  const double c = mw - a * (mx / camera.fx + ray_x) - b * (my / camera.fy + ray_y);
  if (!(a * ray_x + b * ray_y + c > 0)) return;  // the plane would lie behind the camera
  const double length = std::sqrt(a * a + b * b + c * c);
  out->normals_C.x(v, u) = F(-a / length);
  out->normals_C.y(v, u) = F(-b / length);
  out->normals_C.z(v, u) = F(-c / length);
  const double scale = correlation * std::max(camera.fx, camera.fy);
  out->normal_sigma(v, u) = F(sigma * scale / length * std::sqrt(trace / det));
}

SurfaceMap EmptySurface(int width, int height) {
  const Image<float> none(width, height, kNaN), zeros(width, height);
  const Image<uint8_t> zero_bytes(width, height);
  return {{none, none, none},
          {none, none, none},
          none,
          zeros,
          zero_bytes,
          zero_bytes,
          {zero_bytes, zero_bytes, zero_bytes, zero_bytes}};
}

template <typename Visit>
void ForPixels(const PinholeCamera& camera, const Visit& visit) {
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) visit(v, u);
  }
}

}  // namespace

SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options) {
  Require(options.method == NormalMethod::kInverseDepthFit,
          "the naive surface has the method kInverseDepthFit only");
  SurfaceMap out = EmptySurface(camera.width, camera.height);
  InverseDepth inverse{Image<float>(camera.width, camera.height),
                       Image<float>(camera.width, camera.height)};
  ForPixels(camera,
            [&](int v, int u) { BackProject(v, u, depth(v, u), camera, options, &inverse, &out); });
  const double tangent = std::tan(options.max_incidence_deg * std::numbers::pi / 180);
  const float jump_sigmas = F(JumpSigmas(inverse.w, inverse.sigma, options.jump_sigmas));
  const float max_step_x = F(tangent / camera.fx), max_step_y = F(tangent / camera.fy);
  ForPixels(camera, [&](int v, int u) {
    const bool right = Joined(inverse, v, u, 0, 1, jump_sigmas, max_step_x);
    const bool down = Joined(inverse, v, u, 1, 0, jump_sigmas, max_step_y);
    out.joined(v, u) = static_cast<uint8_t>((right ? kJoinedRight : 0) | (down ? kJoinedDown : 0));
  });
  ForPixels(camera, [&](int v, int u) {
    out.reach.left(v, u) = Reach(out, v, u, 0, -1);
    out.reach.right(v, u) = Reach(out, v, u, 0, 1);
    out.reach.up(v, u) = Reach(out, v, u, -1, 0);
    out.reach.down(v, u) = Reach(out, v, u, 1, 0);
  });
  ForPixels(camera, [&](int v, int u) {
    if (inverse.w(v, u) == 0) return;
    FitNormal(SumWindow(inverse, out, v, u), camera, inverse.sigma(v, u),
              options.noise.correlation_px, v, u, &out);
  });
  return out;
}

}  // namespace vismap::naive
