#include "simulation/seen_surface.h"

#include <cmath>

namespace vismap {
namespace {

constexpr int kSeenPixels = 50;  // a frame shows an object if it has at least so many pixels

// Whether a point of the surface is visible: its depth agrees with that of its pixel within 2 %.
bool IsVisible(const PinholeCamera& camera, const Pose& T_C_W, const Image<float>& depth,
               const Eigen::Vector3d& p_W) {
  const Eigen::Vector3d p_C = T_C_W * p_W;
  if (p_C.z() < 0.1) return false;
  const Eigen::Vector2d pixel = camera.Project(p_C);
  const int u = static_cast<int>(std::floor(pixel.x() + 0.5));
  const int v = static_cast<int>(std::floor(pixel.y() + 0.5));
  return depth.Contains(v, u) && std::abs(p_C.z() - double{depth(v, u)}) < 0.02 * p_C.z();
}

}  // namespace

void SeenSurface::AddView(const FrameHeader& header, Rendering&& image) {
  std::map<uint16_t, int> pixels;
  for (const uint16_t id : image.object_ids.pixels()) ++pixels[id];
  for (const auto& [id, count] : pixels) frames_of_object_[id] += count >= kSeenPixels;
  camera_ = header.camera;
  T_C_W_.push_back(header.T_W_C.inverse());
  depths_.push_back(std::move(image.depth));
}

bool SeenSurface::IsSeen(const Eigen::Vector3d& p_W) const {
  for (size_t i = 0; i < depths_.size(); ++i) {
    if (IsVisible(camera_, T_C_W_[i], depths_[i], p_W)) return true;
  }
  return false;
}

LabelledMesh SeenSurface::Triangles(const Scene& scene, double spacing) const {
  return Tessellate(scene, spacing, [&](const Eigen::Vector3d& p_W, const Eigen::Vector3d&) {
    return IsSeen(p_W);
  });
}

SeenSurface RenderSeenSurface(const SyntheticOptions& options) {
  const Scene scene = MakeScene(options);
  SeenSurface seen;
  for (const FrameHeader& header : MakeHeaders(options))
    seen.AddView(header, Render(scene, header.camera, header.T_W_C));
  return seen;
}

}  // namespace vismap
