#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "geometry/pose.h"

namespace vismap {

/// Ray parameter of a ray that hits nothing.
inline constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// A solid with a closed formula for everything: the atom of analytic scenes. Its own frame O has
/// the origin in its centre. All sizes are half: from the centre to the surface.
struct Shape {
  enum class Kind {
    kBox,        ///< half_size = half edge lengths
    kEllipsoid,  ///< half_size = radii
    kCylinder,   ///< axis z; half_size = (radius, radius, half height)
  };
  Kind kind = Kind::kBox;
  Pose T_W_O = Pose::Identity();
  Eigen::Vector3d half_size = Eigen::Vector3d::Ones();  ///< [m]
};

/// Smallest t > 0 with origin_O + t * direction_O entering the solid; kNoHit when there is none.
/// A ray that starts inside does not enter. Everything in the shape's frame; direction of any
/// length.
double EnterSolid(const Shape& shape, const Eigen::Vector3d& origin_O,
                  const Eigen::Vector3d& direction_O);

/// Unit outward normal at a point of the surface, in the shape's frame.
Eigen::Vector3d OutwardNormal(const Shape& shape, const Eigen::Vector3d& p_O);

/// Distance to the surface [m], positive outside, negative inside; exact (ellipsoids to 1e-9 m).
double SignedDistance(const Shape& shape, const Eigen::Vector3d& p_W);

/// Smallest axis-aligned box in the world that holds the shape.
Eigen::AlignedBox3d BoundingBox(const Shape& shape);

}  // namespace vismap
