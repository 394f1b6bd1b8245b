#include "pictures/report_path.h"

#include <optional>
#include <vector>

#include "base/format.h"
#include "pictures/html.h"
#include "render/drawing.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

std::vector<Vector3d> PathOf(CameraId camera, std::span<const CameraPose> trajectory) {
  std::vector<Vector3d> path_W;
  for (const CameraPose& pose : trajectory)
    if (pose.camera_id == camera) path_W.push_back(pose.T_W_C.translation());
  return path_W;
}

Rgb8 Pale(Rgb8 color) {
  const int grey = (color.r + color.g + color.b) / 3;
  const auto pale = static_cast<uint8_t>(150 + grey * 100 / 255);
  return {pale, pale, pale};
}

double LengthOf(const std::vector<Vector3d>& path_W) {
  double length = 0;
  for (size_t i = 1; i < path_W.size(); ++i) length += (path_W[i] - path_W[i - 1]).norm();
  return length;
}

void DrawPath(const std::vector<Vector3d>& path_W, const View& view, Rgb8 color,
              Image<Rgb8>* picture) {
  std::optional<Eigen::Vector2d> last;
  for (const Vector3d& p_W : path_W) {
    const auto pixel = ProjectToView(view, p_W);
    if (pixel && last) DrawLine(*last, *pixel, color, 2, picture);
    last = pixel;
  }
  if (path_W.empty()) return;
  if (const auto start = ProjectToView(view, path_W[0])) DrawDisc(*start, 5, kInk, picture);
}

}  // namespace

std::set<CameraId> CamerasOf(std::span<const CameraPose> trajectory) {
  std::set<CameraId> cameras;
  for (const CameraPose& pose : trajectory) cameras.insert(pose.camera_id);
  return cameras;
}

std::string TrajectoryHtml(std::span<const CameraPose> trajectory, const Mesh& mesh,
                           const SceneBox& scene, const PictureSize& size) {
  if (trajectory.empty()) return Remark("The map has no trajectory.");
  const int rows = size.height - kTitleRows - LegendRows(size.height);
  const View view = TopDownView(scene, size.width, rows);
  Image<Rgb8> picture = RenderMesh(mesh, view, Coloring::kSegment);
  for (Rgb8& pixel : picture.pixels()) pixel = Pale(pixel);
  Caption caption{"Where the cameras were, seen from above", {}, {}, view.scale};
  HtmlTable table({"camera", "frames", "way [m]"});
  for (const CameraId camera : CamerasOf(trajectory)) {
    const std::vector<Vector3d> path_W = PathOf(camera, trajectory);
    const Rgb8 color = StrongColor(static_cast<uint32_t>(camera) + 1);
    DrawPath(path_W, view, color, &picture);
    const std::string name = "camera " + std::to_string(static_cast<int>(camera));
    caption.legend.push_back({{color}, name});
    table.Add({name, FormatCount(std::ssize(path_W)), Digits(LengthOf(path_W), 2)});
  }
  caption.legend.push_back({{kInk}, "where each began"});
  return WebpFigure(WithCaption(picture, caption, size.height), "Trajectory") + table.Html();
}

}  // namespace vismap
