#pragma once

#include <Eigen/Geometry>
#include <limits>

#include "geometry/pose.h"

namespace vismap {

/// The ray parameter of a ray that hits nothing.
inline constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// A solid with exact formulas for rays and distances; analytic scenes consist of them. The origin
/// of its frame O is its centre. All sizes are from the centre to the surface.
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

/// The smallest t > 0 at which origin_O + t * direction_O enters the solid; kNoHit if it does not.
/// A ray that starts inside does not enter. All in the shape's frame [m]; the direction has any
/// length.
double EnterSolid(const Shape& shape, const Eigen::Vector3d& origin_O,
                  const Eigen::Vector3d& direction_O);

/// The unit outward normal at a point of the surface, both in the shape's frame.
Eigen::Vector3d OutwardNormal(const Shape& shape, const Eigen::Vector3d& p_O);

/// The signed distance of a point of W to the surface [m]: positive outside, negative inside.
/// Exact, for ellipsoids to 1e-9 m.
double SignedDistance(const Shape& shape, const Eigen::Vector3d& p_W);

/// The smallest box along the axes of W that contains the shape [m].
Eigen::AlignedBox3d BoundingBox(const Shape& shape);

}  // namespace vismap
