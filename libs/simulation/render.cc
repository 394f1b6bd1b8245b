#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "base/require.h"
#include "simulation/render_views.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

constexpr int kTile = 16;         // edge of a tile [px]; all its pixels share one depth bound
constexpr int32_t kNothing = -1;  // no view

/// What one pixel shows: the depth along optical z [m] and the index of the view, or kNothing.
struct PixelHit {
  double depth = kNoHit;
  int32_t view = kNothing;
};

/// A view that may be visible in a tile, and a lower bound of its depth there [m].
struct TileView {
  double nearest = 0;
  int32_t view = kNothing;

  friend auto operator<=>(const TileView&, const TileView&) = default;
};

/// A small rectangle of pixels. The result is the same as if every ray were cast against all views
/// in the order of the scene, with the first view winning at equal depth. But the nearest views are
/// checked first, so that views behind all hits can be skipped.
class Tile {
 public:
  Tile(const PinholeCamera& camera, const PixelRect& rect) : camera_(camera), rect_(rect) {
    for (int v = rect.v0; v < rect.v1; ++v) {
      for (int u = rect.u0; u < rect.u1; ++u) {
        directions_C_[Index(v, u)] = camera.BackProject(u, v, 1);
      }
    }
  }

  void Cast(const std::vector<ShapeView>& views) {
    std::vector<TileView> candidates;
    for (size_t i = 0; i < views.size(); ++i) {
      if (views[i].pixels.Intersection(rect_).empty()) continue;
      const double nearest = NearestDepth(views[i], camera_, rect_);
      if (nearest < kNoHit) candidates.push_back({nearest, static_cast<int32_t>(i)});
    }
    std::sort(candidates.begin(), candidates.end());
    double deepest = kNoHit;
    for (const TileView& candidate : candidates) {
      if (candidate.nearest > deepest) break;  // this and all later views are hidden
      Cast(views[static_cast<size_t>(candidate.view)], candidate);
      deepest = DeepestHit();
    }
  }

  const Vector3d& direction_C(int v, int u) const { return directions_C_[Index(v, u)]; }
  const PixelHit& hit(int v, int u) const { return hits_[Index(v, u)]; }

 private:
  size_t Index(int v, int u) const {
    return static_cast<size_t>((v - rect_.v0) * kTile + u - rect_.u0);
  }

  void Cast(const ShapeView& view, const TileView& candidate) {
    const PixelRect part = view.pixels.Intersection(rect_);
    for (int v = part.v0; v < part.v1; ++v) {
      for (int u = part.u0; u < part.u1; ++u) {
        PixelHit& hit = hits_[Index(v, u)];
        if (candidate.nearest > hit.depth) continue;
        const double t = EnterSolid(*view.shape, view.origin_O, view.R_O_C * direction_C(v, u));
        if (t < hit.depth || (t == hit.depth && candidate.view < hit.view)) {
          hit = {t, candidate.view};
        }
      }
    }
  }

  double DeepestHit() const {
    double deepest = 0;
    for (int v = rect_.v0; v < rect_.v1; ++v) {
      for (int u = rect_.u0; u < rect_.u1; ++u) deepest = std::max(deepest, hit(v, u).depth);
    }
    return deepest;
  }

  const PinholeCamera& camera_;
  PixelRect rect_;
  std::array<Vector3d, kTile * kTile>
      directions_C_;  // with z = 1, so that the ray parameter is the depth
  std::array<PixelHit, kTile * kTile> hits_;
};

/// Calls use(v, u, hit, direction_C) for every pixel. Tiles run in parallel.
template <typename Use>
void CastImage(const std::vector<ShapeView>& views, const PinholeCamera& camera, const Use& use) {
  const int columns = (camera.width + kTile - 1) / kTile;
  const int rows = (camera.height + kTile - 1) / kTile;
  ParallelFor(static_cast<size_t>(columns) * static_cast<size_t>(rows), 8, [&](size_t i) {
    const int u0 = kTile * (static_cast<int>(i) % columns);
    const int v0 = kTile * (static_cast<int>(i) / columns);
    const PixelRect rect =
        PixelRect{0, 0, camera.width, camera.height}.Intersection({u0, v0, u0 + kTile, v0 + kTile});
    Tile tile(camera, rect);
    tile.Cast(views);
    for (int v = rect.v0; v < rect.v1; ++v) {
      for (int u = rect.u0; u < rect.u1; ++u) use(v, u, tile.hit(v, u), tile.direction_C(v, u));
    }
  });
}

Rgb8 Scaled(Rgb8 color, double factor) {
  const auto scale = [factor](uint8_t x) { return static_cast<uint8_t>(x * factor + 0.5); };
  return {scale(color.r), scale(color.g), scale(color.b)};
}

/// The brightness factor of a checker pattern of 15 cm in the shape's frame. The pattern is
/// shifted, so that no face of the shape is on a border of it.
double Checker(const Vector3d& p_O) {
  int cells = 0;
  for (int i = 0; i < 3; ++i) cells += static_cast<int>(std::floor((p_O[i] + 0.0371) / 0.15));
  return cells % 2 == 0 ? 1.0 : 0.8;
}

Rgb8 ColorOf(const ShapeView& view, const Vector3d& p_O) {
  const Vector3d light_W(0.36, 0.48, 0.8);
  const Vector3d normal_W = view.shape->T_W_O.linear() * OutwardNormal(*view.shape, p_O);
  const double shade = 0.55 + 0.45 * std::abs(normal_W.dot(light_W));
  return Scaled(view.object->color, shade * Checker(p_O));
}

}  // namespace

Rendering Render(const Scene& scene, const PinholeCamera& camera, const Pose& T_W_C) {
  Require(ValidateCamera(camera).has_value(), "rendering needs a valid camera");
  const std::vector<ShapeView> views = MakeShapeViews(scene, camera, T_W_C);
  Rendering image{
      Image<float>(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN()),
      Image<uint16_t>(camera.width, camera.height), Image<Rgb8>(camera.width, camera.height)};
  const auto paint = [&](int v, int u, const PixelHit& hit, const Vector3d& direction_C) {
    if (hit.view == kNothing) return;
    const ShapeView& view = views[static_cast<size_t>(hit.view)];
    image.depth(v, u) = static_cast<float>(hit.depth);
    image.object_ids(v, u) = view.object->id;
    image.color(v, u) = ColorOf(view, view.origin_O + hit.depth * (view.R_O_C * direction_C));
  };
  CastImage(views, camera, paint);
  return image;
}

Image<uint16_t> RenderInstances(const Scene& scene, const PinholeCamera& camera,
                                const Pose& T_W_C) {
  Require(ValidateCamera(camera).has_value(), "rendering needs a valid camera");
  const std::vector<ShapeView> views = MakeShapeViews(scene, camera, T_W_C);
  Image<uint16_t> ids(camera.width, camera.height);
  CastImage(views, camera, [&](int v, int u, const PixelHit& hit, const Vector3d&) {
    if (hit.view != kNothing) ids(v, u) = views[static_cast<size_t>(hit.view)].object->id;
  });
  return ids;
}

}  // namespace vismap
