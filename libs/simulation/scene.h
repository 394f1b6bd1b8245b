#pragma once

// The analytic world: solids put together to objects, objects to scenes, with exact answers to
// "what does this ray hit" and "how far is the surface". What a camera makes of it is in
// simulate.h. The truth of every test that needs one; not part of what runs on a robot.

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/ids.h"
#include "geometry/image.h"
#include "simulation/shape.h"

namespace vismap {

/// What an object is to the system under test.
enum class ObjectKind {
  kStructure,  ///< floor, walls, ceiling: no detector, no discovery
  kKnown,      ///< the simulated detector knows its class
  kUnknown,    ///< only geometry can find it
};

/// One object: the union of its shapes.
struct SceneObject {
  uint16_t id = 0;  ///< 1..65535, unique in the scene; what instance images show
  std::string name;
  ClassId class_id = ClassId::kUnknown;  ///< COCO; kUnknown unless kKnown
  ObjectKind kind = ObjectKind::kUnknown;
  Rgb8 color;
  std::vector<Shape> shapes;
  int64_t first_frame = 0;        ///< it is there in frames with numbers from here ...
  int64_t end_frame = INT64_MAX;  ///< ... to below here
};

/// All objects; free space is where no object is.
struct Scene {
  std::string name;
  std::vector<SceneObject> objects;
};

/// Where a ray enters the first object.
struct Hit {
  double t = 0;  ///< ray parameter: origin + t * direction
  uint16_t object_id = 0;
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();  ///< unit, outward
};

/// First object that the ray from `origin_W` enters; `direction_W` of any length. An object around
/// the origin is not seen.
std::optional<Hit> CastRay(const Scene& scene, const Eigen::Vector3d& origin_W,
                           const Eigen::Vector3d& direction_W);

/// Distance to the nearest surface [m]: positive and exact in free space; negative inside objects,
/// where it is the depth below the surface of the deepest shape (exact unless shapes overlap).
/// +infinity for no objects.
double SignedDistance(const Scene& scene, const Eigen::Vector3d& p_W);
double SignedDistance(const SceneObject& object, const Eigen::Vector3d& p_W);

/// Smallest axis-aligned box in the world that holds the object.
Eigen::AlignedBox3d BoundingBox(const SceneObject& object);

/// The scene with those objects only that are there in this frame.
Scene SceneInFrame(const Scene& scene, int64_t frame_number);

/// The object with this id, or null.
const SceneObject* FindObject(const Scene& scene, uint16_t id);

}  // namespace vismap
