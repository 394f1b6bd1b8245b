#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/require.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

constexpr int32_t kNothing = -1;

/// A shape as one camera sees it.
struct View {
  const Shape* shape = nullptr;
  const SceneObject* object = nullptr;
  Vector3d origin_O;                   ///< of the camera
  Eigen::Matrix3d R_O_C;               ///< directions of pixels
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;  ///< no pixel outside [u0, u1) x [v0, v1) shows it
};

std::array<Vector3d, 8> CornersInCamera(const Shape& shape, const Pose& T_C_W) {
  const Pose T_C_O = T_C_W * shape.T_W_O;
  std::array<Vector3d, 8> corners;
  for (int i = 0; i < 8; ++i) {
    const Vector3d sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    corners[static_cast<size_t>(i)] = T_C_O * shape.half_size.cwiseProduct(sign);
  }
  return corners;
}

/// Bounds the pixels of a shape by its box, cut off in front of the camera, so that most rays skip
/// most shapes; false when it is out of sight.
bool BoundPixels(const std::array<Vector3d, 8>& corners, const PinholeCamera& camera, View* view) {
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
  if (box.isEmpty()) return false;
  const auto clamp = [](double x, int size) {
    return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(size)));
  };
  view->u0 = clamp(std::floor(box.min().x()), camera.width);
  view->v0 = clamp(std::floor(box.min().y()), camera.height);
  view->u1 = clamp(std::ceil(box.max().x()) + 1, camera.width);
  view->v1 = clamp(std::ceil(box.max().y()) + 1, camera.height);
  return view->u0 < view->u1 && view->v0 < view->v1;
}

std::vector<View> MakeViews(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C) {
  const Pose T_C_W = T_W_C.inverse();
  std::vector<View> views;
  for (const SceneObject& object : scene.objects) {
    for (const Shape& shape : object.shapes) {
      const Pose T_O_C = shape.T_W_O.inverse() * T_W_C;
      View view{&shape, &object, T_O_C.translation(), T_O_C.linear()};
      if (BoundPixels(CornersInCamera(shape, T_C_W), camera, &view)) views.push_back(view);
    }
  }
  return views;
}

/// What one pixel shows: depth along optical z and the index of the view, or kNothing.
struct PixelHit {
  double depth = kNoHit;
  int32_t view = kNothing;
};

Vector3d DirectionInCamera(const PinholeCamera& camera, int v, int u) {
  return camera.BackProject(u, v, 1);
}

/// Calls use(v, u, hit) for every pixel, rows in parallel.
template <typename Use>
void CastImage(const std::vector<View>& views, const PinholeCamera& camera, const Use& use) {
  ParallelFor(static_cast<size_t>(camera.height), 8, [&](size_t row) {
    const int v = static_cast<int>(row);
    std::vector<PixelHit> hits(static_cast<size_t>(camera.width));
    for (size_t i = 0; i < views.size(); ++i) {
      const View& view = views[i];
      if (v < view.v0 || v >= view.v1) continue;
      for (int u = view.u0; u < view.u1; ++u) {
        PixelHit& hit = hits[static_cast<size_t>(u)];
        // the direction has z = 1, so that the ray parameter is the depth
        const double t =
            EnterSolid(*view.shape, view.origin_O, view.R_O_C * DirectionInCamera(camera, v, u));
        if (t < hit.depth) hit = {t, static_cast<int32_t>(i)};
      }
    }
    for (int u = 0; u < camera.width; ++u) use(v, u, hits[static_cast<size_t>(u)]);
  });
}

Rgb8 Scaled(Rgb8 color, double factor) {
  const auto scale = [factor](uint8_t x) { return static_cast<uint8_t>(x * factor + 0.5); };
  return {scale(color.r), scale(color.g), scale(color.b)};
}

/// Checks of 15 cm in the shape's frame, off its symmetry planes so that no face lies on their
/// border.
double Checker(const Vector3d& p_O) {
  int cells = 0;
  for (int i = 0; i < 3; ++i) cells += static_cast<int>(std::floor((p_O[i] + 0.0371) / 0.15));
  return cells % 2 == 0 ? 1.0 : 0.8;
}

Rgb8 ColorOf(const View& view, const Vector3d& p_O) {
  const Vector3d light_W(0.36, 0.48, 0.8);
  const Vector3d normal_W = view.shape->T_W_O.linear() * OutwardNormal(*view.shape, p_O);
  const double shade = 0.55 + 0.45 * std::abs(normal_W.dot(light_W));
  return Scaled(view.object->color, shade * Checker(p_O));
}

}  // namespace

Rendering Render(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C) {
  Require(ValidateCamera(camera).has_value(), "rendering needs a valid camera");
  const std::vector<View> views = MakeViews(scene, camera, T_W_C);
  Rendering image{
      Image<float>(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN()),
      Image<uint16_t>(camera.width, camera.height), Image<Rgb8>(camera.width, camera.height)};
  CastImage(views, camera, [&](int v, int u, const PixelHit& hit) {
    if (hit.view == kNothing) return;
    const View& view = views[static_cast<size_t>(hit.view)];
    image.depth(v, u) = static_cast<float>(hit.depth);
    image.object_ids(v, u) = view.object->id;
    image.color(v, u) =
        ColorOf(view, view.origin_O + hit.depth * (view.R_O_C * DirectionInCamera(camera, v, u)));
  });
  return image;
}

Image<uint16_t> RenderInstances(const Scene& scene, const PinholeCamera& camera,
                                const Pose& T_W_C) {
  Require(ValidateCamera(camera).has_value(), "rendering needs a valid camera");
  const std::vector<View> views = MakeViews(scene, camera, T_W_C);
  Image<uint16_t> ids(camera.width, camera.height);
  CastImage(views, camera, [&](int v, int u, const PixelHit& hit) {
    if (hit.view != kNothing) ids(v, u) = views[static_cast<size_t>(hit.view)].object->id;
  });
  return ids;
}

}  // namespace vismap
