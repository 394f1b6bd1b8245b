#include "simulation/render_views.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vismap {
namespace {

using Eigen::Vector3d;

std::array<Vector3d, 8> CornersInCamera(const Shape& shape, const Pose& T_C_W) {
  const Pose T_C_O = T_C_W * shape.T_W_O;
  std::array<Vector3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corners[static_cast<size_t>(i)] = T_C_O * shape.half_size.cwiseProduct(sign);
  }
  return corners;
}

/// The pixels that a shape can cover, from the corners of its box in C, clipped at the near plane.
/// Rays of other pixels need not be tested. Empty if the shape is not in view.
PixelRect BoundPixels(const std::array<Vector3d, 8>& corners, const PinholeCamera& camera) {
  constexpr double kNear = 1e-3;
  Eigen::AlignedBox2d box;
  for (int i = 0; i < 8; ++i) {
    const Vector3d& a = corners[static_cast<size_t>(i)];
    if (a.z() >= kNear) box.extend(camera.Project(a));
    for (const int bit : {1, 2, 4}) {
      const Vector3d& b = corners[static_cast<size_t>(i ^ bit)];
      if (a.z() >= kNear || b.z() < kNear) continue;
      Vector3d cut = a + (b - a) * ((kNear - a.z()) / (b.z() - a.z()));
      cut.z() = kNear;
      box.extend(camera.Project(cut));
    }
  }
  if (box.isEmpty()) return {};
  const auto clamp = [](double x, int size) {
    return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(size)));
  };
  return {clamp(std::floor(box.min().x()), camera.width),
          clamp(std::floor(box.min().y()), camera.height),
          clamp(std::ceil(box.max().x()) + 1, camera.width),
          clamp(std::ceil(box.max().y()) + 1, camera.height)};
}

/// An interval of ray parameters that contains the entries and exits of all rays of a bundle.
struct Span {
  double enter = 0;
  double leave = kNoHit;
};

/// The interval for rays from `origin` through the slab [-half, half], with direction components in
/// [slowest, fastest].
Span CrossSlab(double origin, double half, double slowest, double fastest) {
  if (origin > half) return CrossSlab(-origin, half, -fastest, -slowest);
  const bool outside = origin < -half;
  Span span;
  if (outside) span.enter = fastest > 0 ? (-half - origin) / fastest : kNoHit;
  if (slowest > 0) span.leave = (half - origin) / slowest;
  if (!outside && fastest < 0) span.leave = (half + origin) / -fastest;
  return span;
}

}  // namespace

PixelRect PixelRect::Intersection(const PixelRect& other) const {
  return {std::max(u0, other.u0), std::max(v0, other.v0), std::min(u1, other.u1),
          std::min(v1, other.v1)};
}

std::vector<ShapeView> MakeShapeViews(const Scene& scene, const PinholeCamera& camera,
                                      const Pose& T_W_C) {
  const Pose T_C_W = T_W_C.inverse();
  std::vector<ShapeView> views;
  for (const SceneObject& object : scene.objects) {
    for (const Shape& shape : object.shapes) {
      const PixelRect pixels = BoundPixels(CornersInCamera(shape, T_C_W), camera);
      if (pixels.empty()) continue;
      const Pose T_O_C = shape.T_W_O.inverse() * T_W_C;
      views.push_back({&shape, &object, T_O_C.translation(), T_O_C.linear(), pixels});
    }
  }
  return views;
}

double NearestDepth(const ShapeView& view, const PinholeCamera& camera, const PixelRect& rect) {
  // Tolerance for rounding: of rays that graze a cylinder tens of metres away, the error is less
  // than a micrometre.
  constexpr double kRounding = 1e-5;
  // Directions have z = 1 in C, so that the ray parameter is the depth.
  const Vector3d first = camera.BackProject(rect.u0, rect.v0, 1);
  const Vector3d last = camera.BackProject(rect.u1 - 1, rect.v1 - 1, 1);
  const Vector3d middle_O = view.R_O_C * (0.5 * (first + last));
  const Vector3d reach_O =
      view.R_O_C.cwiseAbs() * (0.5 * (last - first)) + Vector3d::Constant(1e-9);
  Span span;
  for (int i = 0; i < 3; ++i) {
    const Span slab = CrossSlab(view.origin_O[i], view.shape->half_size[i] + kRounding,
                                middle_O[i] - reach_O[i], middle_O[i] + reach_O[i]);
    span.enter = std::max(span.enter, slab.enter);
    span.leave = std::min(span.leave, slab.leave);
  }
  if (span.enter == kNoHit || span.enter * (1 - kRounding) > span.leave * (1 + kRounding)) {
    return kNoHit;
  }
  return span.enter * (1 - kRounding);
}

}  // namespace vismap
