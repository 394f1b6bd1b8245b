#pragma once

// The room `simulation` has analytic scenes: solids form objects, and objects form scenes. Ray
// casting and distances to the surface are exact. simulate.h computes what a camera measures of a
// scene. Scenes are the ground truth of tests; nothing of this room runs on a robot.

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/ids.h"
#include "geometry/image.h"
#include "simulation/shape.h"

namespace vismap {

/// How the system under test can find an object.
enum class ObjectKind {
  kStructure,  ///< floor, walls, ceiling: not to be found as an object
  kKnown,      ///< the simulated detector knows its class
  kUnknown,    ///< only the geometry can find it
};

/// One object: the union of its shapes.
struct SceneObject {
  uint16_t id = 0;  ///< 1..65535, unique in the scene; the value in instance images
  std::string name;
  ClassId class_id = ClassId::kUnknown;  ///< COCO class; kUnknown unless `kind` is kKnown
  ObjectKind kind = ObjectKind::kUnknown;
  Rgb8 color;
  std::vector<Shape> shapes;
  int64_t first_frame = 0;        ///< the object is present in frames with numbers
  int64_t end_frame = INT64_MAX;  ///< in [first_frame, end_frame)
};

/// All objects of a scene. Space without an object is free.
struct Scene {
  std::string name;
  std::vector<SceneObject> objects;
};

/// The signed distance of a point of W to the nearest surface [m]. It is positive and exact in free
/// space. Inside of objects it is negative: the depth below the surface of the shape in which the
/// point is deepest, which is exact unless shapes overlap. +infinity without objects.
double SignedDistance(const Scene& scene, const Eigen::Vector3d& p_W);
double SignedDistance(const SceneObject& object, const Eigen::Vector3d& p_W);

/// The smallest box along the axes of W that contains the object [m].
Eigen::AlignedBox3d BoundingBox(const SceneObject& object);

/// The scene with only the objects that are present in this frame.
Scene SceneInFrame(const Scene& scene, int64_t frame_number);

/// The object with this id, or null.
const SceneObject* FindObject(const Scene& scene, uint16_t id);

}  // namespace vismap
