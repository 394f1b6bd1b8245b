#pragma once

#include <optional>

#include "simulation/scene.h"

namespace vismap::testing_support {

/// Where a ray enters the first object.
struct Hit {
  double t = 0;  ///< ray parameter: origin + t * direction
  uint16_t object_id = 0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();  ///< unit length, outward
};

/// The first object that the ray from `origin_W` [m] enters; `direction_W` has any length. An
/// object that contains the origin is not hit.
inline std::optional<Hit> CastRay(const Scene& scene, const Eigen::Vector3d& origin_W,
                                  const Eigen::Vector3d& direction_W) {
  std::optional<Hit> first;
  for (const SceneObject& object : scene.objects) {
    for (const Shape& shape : object.shapes) {
      const Pose T_O_W = shape.T_W_O.inverse();
      const Eigen::Vector3d origin_O = T_O_W * origin_W;
      const Eigen::Vector3d direction_O = T_O_W.linear() * direction_W;
      const double t = EnterSolid(shape, origin_O, direction_O);
      if (t >= (first ? first->t : kNoHit)) continue;
      const Eigen::Vector3d normal_O = OutwardNormal(shape, origin_O + t * direction_O);
      first = Hit{t, object.id, shape.T_W_O.linear() * normal_O};
    }
  }
  return first;
}

}  // namespace vismap::testing_support
