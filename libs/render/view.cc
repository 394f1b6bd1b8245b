#include "render/view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "objects/oriented_box.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;

// The normal of triangle i, with twice its area as length.
Vector3d FaceVector(const Mesh& mesh, size_t i) {
  const auto at = [&](size_t corner) -> Vector3d {
    return mesh.vertices[mesh.triangles[i][corner]].position_W.cast<double>();
  };
  return (at(1) - at(0)).cross(at(2) - at(0));
}

// The face vectors of at most `limit` triangles, evenly chosen.
std::vector<Vector3d> SampleFaces(const Mesh& mesh, size_t limit) {
  const size_t stride = mesh.triangles.size() / limit + 1;
  std::vector<Vector3d> faces;
  for (size_t i = 0; i < mesh.triangles.size(); i += stride) faces.push_back(FaceVector(mesh, i));
  return faces;
}

// T_V_W of a viewer at `eye` who looks along `forward`, with the top of the picture towards `up`.
Pose ViewPose(const Vector3d& eye, const Vector3d& forward, const Vector3d& up) {
  const Vector3d z = forward.normalized();
  const Vector3d x = z.cross(up).normalized();
  const Vector3d y = z.cross(x);
  Pose T_W_V = Pose::Identity();
  T_W_V.linear() << x, y, z;
  T_W_V.translation() = eye;
  return T_W_V.inverse();
}

std::array<Vector3d, 8> Corners(const SceneBox& scene) {
  std::array<Vector3d, 8> corners;
  for (size_t i = 0; i < 8; ++i) {
    const Vector3d side(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    corners[i] = scene.center_W + scene.R_W_B * side.cwiseProduct(scene.size);
  }
  return corners;
}

// Unit direction from the scene to the viewer, in W. Angles [rad] are relative to the scene's box.
Vector3d Toward(const SceneBox& scene, double azimuth, double elevation) {
  return scene.R_W_B * Vector3d(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
}

// The distance from the scene's centre [m] at which all corners of its box are in the picture.
double FittingDistance(const SceneBox& scene, const View& view, const Vector3d& toward) {
  const Eigen::Matrix3d R_V_W = ViewPose(toward, -toward, scene.up_W).linear();
  const double margin = 0.94;
  double distance = 0.1;
  for (const Vector3d& corner : Corners(scene)) {
    const Vector3d p = R_V_W * (corner - scene.center_W);
    const double wide = std::abs(p.x()) * view.scale / (margin * view.width / 2);
    const double high = std::abs(p.y()) * view.scale / (margin * view.height / 2);
    distance = std::max(distance, std::max(wide, high) - p.z());
  }
  return distance;
}

Eigen::Vector2d MiddleOf(int width, int height) { return {0.5 * (width - 1), 0.5 * (height - 1)}; }

// A perspective view with its optics alone.
View UnplacedView(int width, int height) {
  View view;
  view.width = width;
  view.height = height;
  view.scale = 1.2 * std::max(width, height);  // 45 degrees across
  view.center = MiddleOf(width, height);
  return view;
}

// The range of the values without the smallest and the largest 0.1 %.
std::pair<double, double> UsualRange(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t cut = values.size() / 1000;
  return {values[cut], values[values.size() - 1 - cut]};
}

// Zooms and shifts the view so that the surface that faces the viewer fills the picture.
void CropToContent(const Mesh& mesh, View* view) {
  const size_t stride = mesh.triangles.size() / 20000 + 1;
  std::vector<double> us, vs;
  for (size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const Vector3d p_W = mesh.vertices[mesh.triangles[i][0]].position_W.cast<double>();
    const Vector3d p = view->T_V_W * p_W;
    // Behind the viewer, or facing away.
    if (p.z() <= 0 || (view->T_V_W.linear() * FaceVector(mesh, i)).dot(p) >= 0) continue;
    us.push_back(p.x() / p.z());
    vs.push_back(p.y() / p.z());
  }
  if (us.empty()) return;
  const auto [u_low, u_high] = UsualRange(us);
  const auto [v_low, v_high] = UsualRange(vs);
  if (u_high <= u_low || v_high <= v_low) return;
  view->scale = 0.92 * std::min(view->width / (u_high - u_low), view->height / (v_high - v_low));
  view->center = MiddleOf(view->width, view->height) -
                 view->scale / 2 * Eigen::Vector2d(u_low + u_high, v_low + v_high);
}

// Moves a direction to the local mean of the face normals: the normalised sum of the face vectors
// within 25 degrees of it, then twice of those within 12 degrees. `area` = length of the last sum.
Vector3d RefineDirection(const std::vector<Vector3d>& faces, Vector3d direction, double* area) {
  for (int round = 0; round < 3; ++round) {
    const double cosine = std::cos((round == 0 ? 25 : 12) * kDegree);
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& face : faces) {
      if (face.dot(direction) > cosine * face.norm()) sum += face;
    }
    *area = sum.norm();
    if (*area == 0) return direction;
    direction = sum / *area;
  }
  return direction;
}

// Unit vectors that are evenly spread over the sphere.
std::vector<Vector3d> Directions(int count) {
  std::vector<Vector3d> directions;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - 2 * (i + 0.5) / count;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return directions;
}

// A direction that much of the surface faces.
struct Peak {
  Vector3d direction;
  double area = 0;
};

// The direction that most of the surface faces, among those within `angle` [rad] of `center`.
Peak StrongestPeak(const std::vector<Vector3d>& faces, const Vector3d& center, double angle) {
  Peak best{center, 0};
  for (const Vector3d& start : Directions(400)) {
    if (start.dot(center) < std::cos(angle)) continue;
    Peak peak;
    peak.direction = RefineDirection(faces, start, &peak.area);
    if (peak.area > best.area && peak.direction.dot(center) >= std::cos(angle)) best = peak;
  }
  return best;
}

}  // namespace

SceneBox FrameScene(const Mesh& mesh, const Vector3d& up_W) {
  const size_t stride = mesh.vertices.size() / 20000 + 1;
  std::vector<Eigen::Vector3f> points;
  for (size_t i = 0; i < mesh.vertices.size(); i += stride) {
    if (mesh.vertices[i].position_W.allFinite()) points.push_back(mesh.vertices[i].position_W);
  }
  SceneBox scene;
  scene.up_W = up_W;
  if (points.empty()) return scene;
  const OrientedBox box = FitUprightBox(points, up_W, 0.01);
  scene.center_W = box.center_W;
  scene.R_W_B = box.R_W_B.toRotationMatrix();
  scene.size = box.size.cwiseMax(0.05);
  return scene;
}

View PerspectiveView(const SceneBox& scene, double azimuth, double elevation, int width,
                     int height) {
  View view = UnplacedView(width, height);
  const Vector3d toward = Toward(scene, azimuth, elevation);
  const Vector3d eye = scene.center_W + toward * FittingDistance(scene, view, toward);
  view.T_V_W = ViewPose(eye, -toward, scene.up_W);
  return view;
}

std::vector<View> TurntableViews(const SceneBox& scene, int count, double elevation, int width,
                                 int height) {
  std::vector<View> views(static_cast<size_t>(count), UnplacedView(width, height));
  const auto toward = [&](size_t i) {
    const double turn = static_cast<double>(i) / static_cast<double>(count);
    return Toward(scene, 2 * std::numbers::pi * turn, elevation);
  };
  double distance = 0;
  for (size_t i = 0; i < views.size(); ++i)
    distance = std::max(distance, FittingDistance(scene, views[i], toward(i)));
  for (size_t i = 0; i < views.size(); ++i)
    views[i].T_V_W = ViewPose(scene.center_W + toward(i) * distance, -toward(i), scene.up_W);
  return views;
}

View TopDownView(const SceneBox& scene, int width, int height) {
  View view;
  view.orthographic = true;
  view.width = width;
  view.height = height;
  // The box is longer along x. Its x axis goes along the longer side of the picture.
  const bool upright = height > width;
  const double across = upright ? scene.size.y() : scene.size.x();
  const double along = upright ? scene.size.x() : scene.size.y();
  view.scale = 0.94 * std::min(width / across, height / along);
  view.center = MiddleOf(width, height);
  const Vector3d eye = scene.center_W + scene.up_W * (scene.size.z() + 1);
  view.T_V_W = ViewPose(eye, -scene.up_W, scene.R_W_B.col(upright ? 0 : 1));
  return view;
}

View BestPerspectiveView(const Mesh& mesh, const SceneBox& scene, int width, int height) {
  const std::vector<Vector3d> faces = SampleFaces(mesh, 20000);
  double most = -1, best_azimuth = 0, best_elevation = 0;
  for (const double elevation : {35 * kDegree, 50 * kDegree}) {
    for (int i = 0; i < 8; ++i) {
      const double azimuth = (22.5 + 45 * i) * kDegree;
      const Vector3d toward = Toward(scene, azimuth, elevation);
      double area = 0;
      for (const Vector3d& face : faces) area += std::max(0.0, face.dot(toward));
      if (area <= most) continue;
      most = area;
      best_azimuth = azimuth;
      best_elevation = elevation;
    }
  }
  View view = PerspectiveView(scene, best_azimuth, best_elevation, width, height);
  CropToContent(mesh, &view);
  return view;
}

Vector3d EstimateUp(const Mesh& mesh, const std::optional<Vector3d>& hint_W) {
  const std::vector<Vector3d> faces = SampleFaces(mesh, 5000);
  if (hint_W) return StrongestPeak(faces, hint_W->normalized(), 40 * kDegree).direction;
  const Peak usual = StrongestPeak(faces, Vector3d::UnitZ(), 15 * kDegree);
  const Peak any = StrongestPeak(faces, Vector3d::UnitZ(), std::numbers::pi);
  return usual.area >= 0.3 * any.area ? usual.direction : any.direction;
}

}  // namespace vismap
