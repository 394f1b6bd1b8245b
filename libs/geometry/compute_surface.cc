#include "geometry/compute_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/require.h"
#include "geometry/window_normals.h"

namespace vismap {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr size_t kRowGrain = 8;

/// Inverse depth [1/m] and its standard deviation; both 0 = no return.
struct InverseDepth {
  Image<float> w, sigma;
};

/// Sums over the horizontal window of every pixel, x counted from that pixel.
struct RowSums {
  Image<float> n, x, xx, w, xw;
};

void PrepareRow(const float* depth, const PinholeCamera& camera, const SurfaceOptions& options,
                int v, InverseDepth* inverse, SurfaceMap* out) {
  const auto low = static_cast<float>(options.min_depth);
  const auto high = static_cast<float>(options.max_depth);
  const auto base = static_cast<float>(options.noise.axial_base);
  const auto quadratic = static_cast<float>(options.noise.axial_quadratic);
  const auto offset = static_cast<float>(options.noise.axial_offset);
  const auto step = static_cast<float>(options.noise.disparity_step / std::sqrt(12.0));
  const float inv_fx = static_cast<float>(1 / camera.fx);
  const float x0 = static_cast<float>(-camera.cx / camera.fx);
  const float y = static_cast<float>((v - camera.cy) / camera.fy);
  float* px = out->points_C.x.row(v);
  float* py = out->points_C.y.row(v);
  float* pz = out->points_C.z.row(v);
  float* w = inverse->w.row(v);
  float* sigma = inverse->sigma.row(v);
  float* depth_sigma = out->depth_sigma.row(v);
  for (int u = 0; u < camera.width; ++u) {
    const float z = depth[u];
    const bool valid = z >= low && z <= high;
    const float inv = 1 / (valid ? z : 1.0F);
    const float past = std::max(z - offset, 0.0F);
    const float axial = (base + quadratic * past * past) * inv * inv;
    pz[u] = valid ? z : kNaN;
    px[u] = pz[u] * (x0 + inv_fx * static_cast<float>(u));
    py[u] = pz[u] * y;
    w[u] = valid ? inv : 0.0F;
    sigma[u] = valid ? std::sqrt(axial * axial + step * step) : 0.0F;
    depth_sigma[u] = valid ? sigma[u] * z * z : 0.0F;
  }
}

/// Whether p and q = its neighbour lie on one surface, given the pixels before p and after q in
/// line. `cap` is the largest step that the slope of a surface explains.
inline bool Joined(float before, float p, float q, float after, float tolerance, float cap) {
  const float step = q - p;
  const float from_before = before > 0 ? std::abs(step - (p - before)) : std::abs(step);
  const float from_after = after > 0 ? std::abs(step - (after - q)) : std::abs(step);
  const bool level = std::abs(step) <= tolerance;
  const bool sloped =
      (std::min(from_before, from_after) <= tolerance) & (std::abs(step) <= cap + tolerance);
  return (p > 0) & (q > 0) & (level | sloped);
}

void JoinRow(const InverseDepth& inverse, const PinholeCamera& camera,
             const SurfaceOptions& options, int v, Image<uint8_t>* joined) {
  const int width = inverse.w.width(), last_row = inverse.w.height() - 1;
  const auto k = static_cast<float>(options.jump_sigmas);
  const double tangent = std::tan(options.max_incidence_deg * std::numbers::pi / 180);
  const auto cap_x = static_cast<float>(tangent / camera.fx);
  const auto cap_y = static_cast<float>(tangent / camera.fy);
  const float* w = inverse.w.row(v);
  const float* sigma = inverse.sigma.row(v);
  uint8_t* out = joined->row(v);
  for (int u = 0; u + 1 < width; ++u) {
    const float before = u > 0 ? w[u - 1] : 0, after = u + 2 < width ? w[u + 2] : 0;
    if (Joined(before, w[u], w[u + 1], after, k * std::max(sigma[u], sigma[u + 1]), cap_x * w[u])) {
      out[u] |= kJoinedRight;
    }
  }
  if (v == last_row) return;
  const float* below = inverse.w.row(v + 1);
  const float* sigma_below = inverse.sigma.row(v + 1);
  const float* above = v > 0 ? inverse.w.row(v - 1) : nullptr;
  const float* second = v + 2 <= last_row ? inverse.w.row(v + 2) : nullptr;
  for (int u = 0; u < width; ++u) {
    if (Joined(above ? above[u] : 0, w[u], below[u], second ? second[u] : 0,
               k * std::max(sigma[u], sigma_below[u]), cap_y * w[u])) {
      out[u] |= kJoinedDown;
    }
  }
}

/// Window radius at which a plane fit reaches the wanted normal error: the slope of a square window
/// of radius r errs by about sqrt(3)/2 sigma / r^2 per pixel, the normal by that times f z, both
/// times the noise's correlation length.
void RadiusRow(const InverseDepth& inverse, const PinholeCamera& camera,
               const SurfaceOptions& options, int v, Image<uint8_t>* radius) {
  const double scale = std::max(1.0, inverse.w.width() / 640.0);
  const auto low = static_cast<float>(options.min_radius);
  const auto high = static_cast<float>(std::min(31.0, options.max_radius * scale));
  const auto gain =
      static_cast<float>(0.5 * std::sqrt(3.0) * camera.fx * options.noise.correlation /
                         (options.normal_sigma_deg * std::numbers::pi / 180));
  const float* w = inverse.w.row(v);
  const float* sigma = inverse.sigma.row(v);
  uint8_t* out = radius->row(v);
  for (int u = 0; u < inverse.w.width(); ++u) {
    const float wanted = std::ceil(std::sqrt(gain * sigma[u] / std::max(w[u], 1e-6F)));
    out[u] = w[u] > 0 ? static_cast<uint8_t>(std::clamp(wanted, low, high)) : uint8_t{0};
  }
}

/// How far each pixel sees along its row, and the sums over that stretch.
void SumRow(const InverseDepth& inverse, const SurfaceMap& surface, int v, RowSums* sums) {
  const int width = inverse.w.width();
  const float* w = inverse.w.row(v);
  const uint8_t* joined = surface.joined.row(v);
  const uint8_t* radius = surface.radius.row(v);
  std::vector<double> prefix_w(static_cast<size_t>(width) + 1), prefix_uw(prefix_w.size());
  std::vector<int> left(static_cast<size_t>(width)), right(left.size());
  for (int u = 0; u < width; ++u) {
    const auto i = static_cast<size_t>(u);
    prefix_w[i + 1] = prefix_w[i] + w[u];
    prefix_uw[i + 1] = prefix_uw[i] + static_cast<double>(u) * w[u];
    left[i] = u > 0 && (joined[u - 1] & kJoinedRight) ? left[i - 1] + 1 : 0;
  }
  for (int u = width - 2; u >= 0; --u) {
    const auto i = static_cast<size_t>(u);
    right[i] = (joined[u] & kJoinedRight) ? right[i + 1] + 1 : 0;
  }
  for (int u = 0; u < width; ++u) {
    const auto i = static_cast<size_t>(u);
    const int l = std::min<int>(left[i], radius[u]), r = std::min<int>(right[i], radius[u]);
    const auto a = static_cast<size_t>(u - l), b = static_cast<size_t>(u + r + 1);
    const double sum_w = prefix_w[b] - prefix_w[a];
    const auto valid = static_cast<float>(w[u] > 0);
    sums->n(v, u) = valid * static_cast<float>(l + r + 1);
    sums->x(v, u) = valid * static_cast<float>((r * (r + 1) - l * (l + 1)) / 2);
    sums->xx(v, u) =
        valid * static_cast<float>((r * (r + 1) * (2 * r + 1) + l * (l + 1) * (2 * l + 1)) / 6);
    sums->w(v, u) = valid * static_cast<float>(sum_w);
    sums->xw(v, u) = valid * static_cast<float>(prefix_uw[b] - prefix_uw[a] - u * sum_w);
  }
}

/// How far each pixel sees up (down) its column, at most its radius.
void ReachColumns(const SurfaceMap& surface, Image<uint8_t>* up, Image<uint8_t>* down) {
  const int width = surface.joined.width(), height = surface.joined.height();
  for (int v = 1; v < height; ++v) {
    const uint8_t* joined = surface.joined.row(v - 1);
    for (int u = 0; u < width; ++u) {
      const int reach = (joined[u] & kJoinedDown) ? (*up)(v - 1, u) + 1 : 0;
      (*up)(v, u) = static_cast<uint8_t>(std::min<int>(reach, surface.radius(v, u)));
    }
  }
  for (int v = height - 2; v >= 0; --v) {
    const uint8_t* joined = surface.joined.row(v);
    for (int u = 0; u < width; ++u) {
      const int reach = (joined[u] & kJoinedDown) ? (*down)(v + 1, u) + 1 : 0;
      (*down)(v, u) = static_cast<uint8_t>(std::min<int>(reach, surface.radius(v, u)));
    }
  }
}

/// Moments of the window of each pixel of one row: x and y counted from that pixel.
struct Moments {
  explicit Moments(int width) {
    for (std::vector<float>* sum : {&n, &x, &y, &xx, &xy, &yy, &w, &xw, &yw}) {
      sum->assign(static_cast<size_t>(width), 0.0F);
    }
  }
  std::vector<float> n, x, y, xx, xy, yy, w, xw, yw;
};

void AddRow(const RowSums& sums, int row, int dy, const uint8_t* up, const uint8_t* down,
            Moments* m) {
  const auto y = static_cast<float>(dy);
  const size_t width = m->n.size();
  for (size_t u = 0; u < width; ++u) {
    const float in = (dy < 0 ? -dy <= up[u] : dy <= down[u]) ? 1.0F : 0.0F;
    const float n = in * sums.n.row(row)[u], x = in * sums.x.row(row)[u];
    const float w = in * sums.w.row(row)[u];
    m->n[u] += n;
    m->x[u] += x;
    m->y[u] += y * n;
    m->xx[u] += in * sums.xx.row(row)[u];
    m->xy[u] += y * x;
    m->yy[u] += y * y * n;
    m->w[u] += w;
    m->xw[u] += in * sums.xw.row(row)[u];
    m->yw[u] += y * w;
  }
}

/// Least-squares plane w = a x + b y + c per pixel, turned into a normal and its expected error.
void SolveRow(const Moments& m, const InverseDepth& inverse, const PinholeCamera& camera,
              double correlation, int v, SurfaceMap* out) {
  const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
  const auto sigma_scale = static_cast<float>(correlation) * std::max(fx, fy);
  const float y = static_cast<float>((v - camera.cy) / camera.fy);
  for (size_t u = 0; u < m.n.size(); ++u) {
    const int column = static_cast<int>(u);
    const float inv_n = 1 / std::max(m.n[u], 1.0F);
    const float mx = m.x[u] * inv_n, my = m.y[u] * inv_n, mw = m.w[u] * inv_n;
    const float cxx = m.xx[u] - m.x[u] * mx, cxy = m.xy[u] - m.x[u] * my;
    const float cyy = m.yy[u] - m.y[u] * my;
    const float cxw = m.xw[u] - m.x[u] * mw, cyw = m.yw[u] - m.y[u] * mw;
    const float det = cxx * cyy - cxy * cxy, trace = cxx + cyy;
    // The smaller eigenvalue of the window's shape, about det / trace: two rows of pixels have 1/4.
    const bool plane = det > 0.2F * m.n[u] * trace && m.n[u] >= 5;
    const float inv_det = 1 / (plane ? det : 1.0F);
    const float a = (cxw * cyy - cyw * cxy) * inv_det * fx;
    const float b = (cyw * cxx - cxw * cxy) * inv_det * fy;
    const float x = (static_cast<float>(column) - static_cast<float>(camera.cx)) / fx;
    const float c = mw - a * (mx / fx + x) - b * (my / fy + y);
    const float inv_length = 1 / std::sqrt(a * a + b * b + c * c + 1e-30F);
    // a x + b y + c is the fitted inverse depth at the pixel: positive unless the fit is nonsense.
    const bool good = plane && a * x + b * y + c > 0;
    const float sigma =
        inverse.sigma(v, column) * sigma_scale * inv_length * std::sqrt(trace * inv_det);
    out->normals_C.x(v, column) = good ? -a * inv_length : kNaN;
    out->normals_C.y(v, column) = good ? -b * inv_length : kNaN;
    out->normals_C.z(v, column) = good ? -c * inv_length : kNaN;
    out->normal_sigma(v, column) = good ? sigma : kNaN;
  }
}

void FitNormals(const InverseDepth& inverse, const PinholeCamera& camera, double correlation,
                SurfaceMap* out) {
  const int width = camera.width, height = camera.height;
  const auto rows = static_cast<size_t>(height);
  const Image<float> zero(width, height);
  RowSums sums{zero, zero, zero, zero, zero};
  ParallelFor(rows, kRowGrain,
              [&](size_t v) { SumRow(inverse, *out, static_cast<int>(v), &sums); });
  Image<uint8_t> up(width, height), down(width, height);
  ReachColumns(*out, &up, &down);
  ParallelFor(rows, kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    const int reach_up = *std::max_element(up.row(v), up.row(v) + width);
    const int reach_down = *std::max_element(down.row(v), down.row(v) + width);
    Moments moments(width);
    for (int dy = -reach_up; dy <= reach_down; ++dy) {
      AddRow(sums, v + dy, dy, up.row(v), down.row(v), &moments);
    }
    SolveRow(moments, inverse, camera, correlation, v, out);
  });
}

SurfaceMap EmptySurface(int width, int height) {
  const Image<float> nan(width, height, kNaN);
  const Image<uint8_t> none(width, height);
  return {{nan, nan, nan}, {nan, nan, nan}, nan, Image<float>(width, height), none, none};
}

}  // namespace

SurfaceMap ComputeSurface(const Image<float>& depth, const PinholeCamera& camera,
                          const SurfaceOptions& options) {
  Require(depth.width() == camera.width && depth.height() == camera.height,
          "a depth image has the size of its camera");
  SurfaceMap out = EmptySurface(camera.width, camera.height);
  const auto rows = static_cast<size_t>(camera.height);
  InverseDepth inverse{Image<float>(camera.width, camera.height),
                       Image<float>(camera.width, camera.height)};
  ParallelFor(rows, kRowGrain, [&](size_t row) {
    const int v = static_cast<int>(row);
    PrepareRow(depth.row(v), camera, options, v, &inverse, &out);
    RadiusRow(inverse, camera, options, v, &out.radius);
  });
  ParallelFor(rows, kRowGrain, [&](size_t row) {
    JoinRow(inverse, camera, options, static_cast<int>(row), &out.joined);
  });
  if (options.method == NormalMethod::kWindowCovariance) {
    EstimateWindowNormals(options, &out);
  } else {
    FitNormals(inverse, camera, options.noise.correlation, &out);
  }
  return out;
}

}  // namespace vismap
