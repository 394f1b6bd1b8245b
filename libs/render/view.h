#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "geometry/pose.h"
#include "meshing/mesh.h"

namespace vismap {

/// The camera of a picture. Its frame V is that of a camera: x right, y down, z forward.
struct View {
  Pose T_V_W = Pose::Identity();
  bool orthographic = false;
  double scale = 500;  ///< focal length [px], or pixels per metre when orthographic
  Eigen::Vector2d center{399.5, 299.5};  ///< pixel (u, v) on the optical axis
  int width = 800;                       ///< [px]
  int height = 600;                      ///< [px]
};

/// The part of the world that a picture shows: an upright box around nearly all of the surface.
struct SceneBox {
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();      ///< unit length
  Eigen::Vector3d center_W = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Matrix3d R_W_B = Eigen::Matrix3d::Identity();  ///< axes of the box; the third is up_W
  Eigen::Vector3d size = Eigen::Vector3d::Ones();       ///< edge lengths [m]
};

/// The upright box around a mesh. Along each axis, 1 % of the vertices are left outside. `up_W` has
/// unit length.
SceneBox FrameScene(const Mesh& mesh, const Eigen::Vector3d& up_W);

/// A perspective view from the direction `azimuth`, `elevation` [rad], relative to the scene's box.
/// It is as close as possible with the whole box in the picture. `width`, `height` [px].
View PerspectiveView(const SceneBox& scene, double azimuth, double elevation, int width,
                     int height);

/// `count` perspective views from all around, at one elevation [rad] and one distance.
std::vector<View> TurntableViews(const SceneBox& scene, int count, double elevation, int width,
                                 int height);

/// An orthographic view from straight above, with the longer side of the scene along the longer
/// side of the picture.
View TopDownView(const SceneBox& scene, int width, int height);

/// The perspective view that most of the surface faces, of sixteen views from obliquely above. A
/// room is seen from outside through its near walls, whose back faces are not drawn. A scan from
/// one side is seen from that side. The view is zoomed so that the visible surface fills the
/// picture.
View BestPerspectiveView(const Mesh& mesh, const SceneBox& scene, int width, int height);

/// Estimates the upward direction from the surface, in W, unit length: the direction that most of
/// the area faces, within 40 degrees of `hint_W` (such as the mean of the cameras' -y axes).
/// Without a hint: that direction within 15 degrees of +z if it has at least 0.3 times the area of
/// the strongest direction of all, else the strongest direction. If no surface faces that way, the
/// hint or +z.
Eigen::Vector3d EstimateUp(const Mesh& mesh,
                           const std::optional<Eigen::Vector3d>& hint_W = std::nullopt);

}  // namespace vismap
