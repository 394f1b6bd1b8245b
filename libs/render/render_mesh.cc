#include "render/render_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"

namespace vismap {
namespace {

constexpr double kNear = 0.05;  // smallest depth of a visible vertex [m]
constexpr int kBandRows = 32;   // rows that one thread draws at a time
constexpr int kSmooth = 2;      // samples per pixel and axis

struct ScreenVertex {
  float u = 0, v = 0;
  float closeness = 0;  // larger = nearer to the viewer; linear in screen coordinates
  bool visible = false;
  Eigen::Vector3f rgb = Eigen::Vector3f::Zero();
};

// Brightness [0, 1]: a light at the viewer, and a weak one from above that makes horizontal and
// vertical surfaces look different.
float Shade(const Eigen::Vector3d& normal_V, const Eigen::Vector3d& toward_eye_V) {
  const double head = std::abs(normal_V.dot(toward_eye_V));
  const double above = std::max(0.0, -normal_V.y());
  return static_cast<float>(std::min(1.0, 0.3 + 0.7 * head + 0.1 * above));
}

ScreenVertex ToScreen(const MeshVertex& vertex, const View& view, Coloring coloring) {
  const Eigen::Vector3d p = view.T_V_W * vertex.position_W.cast<double>();
  ScreenVertex screen;
  screen.visible = view.orthographic || p.z() > kNear;
  if (!screen.visible) return screen;
  const double scale = view.orthographic ? view.scale : view.scale / p.z();
  screen.u = static_cast<float>(p.x() * scale + view.center.x());
  screen.v = static_cast<float>(p.y() * scale + view.center.y());
  // This also excludes NaN from the loops over pixels.
  screen.visible = std::abs(screen.u) < 1e6F && std::abs(screen.v) < 1e6F;
  if (!screen.visible) return screen;
  screen.closeness = static_cast<float>(view.orthographic ? -p.z() : 1 / p.z());
  const Eigen::Vector3d normal = view.T_V_W.linear() * vertex.normal_W.cast<double>();
  const Eigen::Vector3d toward =
      view.orthographic ? Eigen::Vector3d(0, 0, -1) : Eigen::Vector3d(-p.normalized());
  const Rgb8 color = VertexColor(vertex, coloring);
  screen.rgb = Eigen::Vector3f(color.r, color.g, color.b) * Shade(normal, toward);
  return screen;
}

std::vector<ScreenVertex> ProjectAll(const Mesh& mesh, const View& view, Coloring coloring) {
  std::vector<ScreenVertex> screen(mesh.vertices.size());
  ParallelFor(screen.size(), 4096,
              [&](size_t i) { screen[i] = ToScreen(mesh.vertices[i], view, coloring); });
  return screen;
}

float Cross(const ScreenVertex& a, const ScreenVertex& b, float u, float v) {
  return (b.u - a.u) * (v - a.v) - (b.v - a.v) * (u - a.u);
}

uint8_t ToByte(float value) { return static_cast<uint8_t>(std::clamp(value + 0.5F, 0.0F, 255.0F)); }

// The rows [begin, end) of a picture, with its depth buffer.
struct Canvas {
  Image<Rgb8>* image;
  Image<float>* closeness;
  int begin, end;
};

// The first and the last pixel centre between the least and the largest of three coordinates,
// limited to [low, high).
std::pair<int, int> PixelRange(float a, float b, float c, int low, int high) {
  const float from = std::max(std::ceil(std::min({a, b, c})), static_cast<float>(low));
  const float to = std::min(std::floor(std::max({a, b, c})), static_cast<float>(high - 1));
  return {static_cast<int>(from), static_cast<int>(to)};
}

void DrawTriangle(const ScreenVertex& a, const ScreenVertex& b, const ScreenVertex& c,
                  const Canvas& canvas) {
  if (!a.visible || !b.visible || !c.visible)
    return;  // triangles are not clipped at the near plane
  // Front faces are counter-clockwise. In the picture, whose v points down, they are clockwise and
  // have a negative area. Back faces are not drawn.
  const float area = Cross(a, b, c.u, c.v);
  if (!(area < 0)) return;
  const auto [v_begin, v_end] = PixelRange(a.v, b.v, c.v, canvas.begin, canvas.end);
  const auto [u_begin, u_end] = PixelRange(a.u, b.u, c.u, 0, canvas.image->width());
  for (int v = v_begin; v <= v_end; ++v) {
    for (int u = u_begin; u <= u_end; ++u) {
      const auto x = static_cast<float>(u), y = static_cast<float>(v);
      const float wa = Cross(b, c, x, y) / area;
      const float wb = Cross(c, a, x, y) / area;
      const float wc = 1 - wa - wb;
      if (wa < 0 || wb < 0 || wc < 0) continue;  // outside of the triangle
      const float closeness = wa * a.closeness + wb * b.closeness + wc * c.closeness;
      if (closeness <= (*canvas.closeness)(v, u)) continue;  // hidden by another triangle
      (*canvas.closeness)(v, u) = closeness;
      const Eigen::Vector3f rgb = wa * a.rgb + wb * b.rgb + wc * c.rgb;
      (*canvas.image)(v, u) = {ToByte(rgb.x()), ToByte(rgb.y()), ToByte(rgb.z())};
    }
  }
}

// Bands of rows are drawn in parallel. Within a band, triangles are drawn in their order, so the
// result does not depend on the number of threads.
Image<Rgb8> Rasterize(const Mesh& mesh, const View& view, Coloring coloring) {
  const std::vector<ScreenVertex> screen = ProjectAll(mesh, view, coloring);
  Image<Rgb8> image(view.width, view.height, kBackground);
  Image<float> closeness(view.width, view.height, -std::numeric_limits<float>::max());
  const auto bands = static_cast<size_t>((view.height + kBandRows - 1) / kBandRows);
  ParallelFor(bands, 1, [&](size_t band) {
    const int begin = static_cast<int>(band) * kBandRows;
    const Canvas canvas{&image, &closeness, begin, std::min(begin + kBandRows, view.height)};
    const auto low = static_cast<float>(canvas.begin), high = static_cast<float>(canvas.end - 1);
    for (const auto& [i, j, k] : mesh.triangles) {
      const ScreenVertex &a = screen[i], &b = screen[j], &c = screen[k];
      if (std::max({a.v, b.v, c.v}) < low || std::min({a.v, b.v, c.v}) > high) continue;
      DrawTriangle(a, b, c, canvas);
    }
  });
  return image;
}

// Averages squares of `factor` x `factor` pixels.
Image<Rgb8> Downsample(const Image<Rgb8>& large, int factor) {
  Image<Rgb8> small(large.width() / factor, large.height() / factor);
  const int samples = factor * factor;
  for (int v = 0; v < small.height(); ++v) {
    for (int u = 0; u < small.width(); ++u) {
      int r = 0, g = 0, b = 0;
      for (int i = 0; i < samples; ++i) {
        const Rgb8& c = large(v * factor + i / factor, u * factor + i % factor);
        r += c.r;
        g += c.g;
        b += c.b;
      }
      const auto mean = [&](int sum) {
        return static_cast<uint8_t>((sum + samples / 2) / samples);
      };
      small(v, u) = {mean(r), mean(g), mean(b)};
    }
  }
  return small;
}

}  // namespace

Image<Rgb8> RenderMesh(const Mesh& mesh, const View& view, Coloring coloring) {
  View fine = view;
  fine.width *= kSmooth;
  fine.height *= kSmooth;
  fine.scale *= kSmooth;
  // The centre of a pixel is between its samples.
  fine.center = (view.center.array() + 0.5) * kSmooth - 0.5;
  return Downsample(Rasterize(mesh, fine, coloring), kSmooth);
}

std::optional<Eigen::Vector2d> ProjectToView(const View& view, const Eigen::Vector3d& p_W) {
  const Eigen::Vector3d p = view.T_V_W * p_W;
  if (!view.orthographic && p.z() <= kNear) return std::nullopt;
  const double scale = view.orthographic ? view.scale : view.scale / p.z();
  return Eigen::Vector2d(p.head<2>() * scale + view.center);
}

}  // namespace vismap
