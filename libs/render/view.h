#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "geometry/pose.h"
#include "meshing/mesh.h"

namespace vismap {

/// Where a picture is taken from. View frame V: x right, y down, z forward, as a camera's.
struct View {
  Pose T_V_W = Pose::Identity();
  bool orthographic = false;
  double scale = 500;  ///< focal length [px], or pixels per metre when orthographic
  Eigen::Vector2d center{399.5, 299.5};  ///< pixel (u, v) that the optical axis passes
  int width = 800;
  int height = 600;
};

/// What of the world a picture should show, and how the world stands.
struct SceneBox {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();      ///< unit
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();   ///< of the box below [m]
  Eigen::Matrix3d R_W_B = Eigen::Matrix3d::Identity();  ///< upright box around nearly everything
  Eigen::Vector3d size = Eigen::Vector3d::Ones();       ///< its edges [m]
};

/// The upright box around the mesh without its outermost 1 %; `up_W` is unit.
SceneBox FrameScene(const Mesh& mesh, const Eigen::Vector3d& up_W);

/// Perspective view at the scene from the direction `azimuth`, `elevation` [rad] of its box, from
/// where all of the box is in the picture.
View PerspectiveView(const SceneBox& scene, double azimuth, double elevation, int width,
                     int height);

/// Straight down on the scene, its longer side across the picture.
View TopDownView(const SceneBox& scene, int width, int height);

/// The perspective view, among sixteen from obliquely above, towards which most surface faces: a
/// room is seen from outside through the backs of its near walls, a scan of one side from where it
/// was taken. Cut so that nearly all of what is visible fills the picture.
View BestPerspectiveView(const Mesh& mesh, const SceneBox& scene, int width, int height);

/// The up direction that the horizontal surfaces say: the direction that most area faces, within 40
/// degrees of `hint_W` (such as the mean of the cameras' -y axes). Without a hint: +z if a fair
/// share of the surface faces there, otherwise the direction that most of the surface faces. The
/// hint itself, or +z, where nothing faces that way.
Eigen::Vector3d EstimateUp(const Mesh& mesh,
                           const std::optional<Eigen::Vector3d>& hint_W = std::nullopt);

}  // namespace vismap
