#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "geometry/camera.h"
#include "simulation/scene.h"

namespace vismap {

/// The pixels [u0, u1) x [v0, v1).
struct PixelRect {
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;

  bool empty() const { return u0 >= u1 || v0 >= v1; }
  PixelRect Intersection(const PixelRect& other) const;
};

/// A shape as one camera sees it.
struct ShapeView {
  const Shape* shape = nullptr;
  const SceneObject* object = nullptr;
  Eigen::Vector3d origin_O;  ///< position of the camera in the shape's frame [m]
  Eigen::Matrix3d R_O_C;
  PixelRect pixels;  ///< no pixel outside of it shows the shape
};

/// The shapes that a camera may see, in the order of the scene. They point into the scene.
std::vector<ShapeView> MakeShapeViews(const Scene& scene, const PinholeCamera& camera,
                                      const Pose& T_W_C);

/// A lower bound of the depths along optical z [m] at which rays through the pixel centres of
/// `rect` enter the shape; kNoHit if no ray can enter it. It is computed from the shape's box and
/// includes a tolerance for rounding.
double NearestDepth(const ShapeView& view, const PinholeCamera& camera, const PixelRect& rect);

}  // namespace vismap
