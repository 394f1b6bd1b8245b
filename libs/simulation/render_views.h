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
  Eigen::Vector3d origin_O;  ///< of the camera
  Eigen::Matrix3d R_O_C;     ///< directions of pixels
  PixelRect pixels;          ///< no pixel outside shows it
};

/// The shapes that a camera may see, in the order of the scene. Valid as long as the scene is.
std::vector<ShapeView> MakeShapeViews(const Scene& scene, const PinholeCamera& camera,
                                      const Pose& T_W_C);

/// No ray through the centre of a pixel of `rect` enters the shape at a smaller depth [m along
/// optical z]; kNoHit when none enters it at all. Found from the shape's box, so a bound only; safe
/// against rounding.
double NearestDepth(const ShapeView& view, const PinholeCamera& camera, const PixelRect& rect);

}  // namespace vismap
