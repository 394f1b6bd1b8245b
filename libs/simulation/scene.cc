#include "simulation/scene.h"

#include <algorithm>

namespace vismap {
namespace {

/// The smaller one of `distance` and the distance to the shape [m]. A bound from the shape's size
/// avoids the exact computation for most shapes.
double Nearer(const Shape& shape, const Eigen::Vector3d& p_W, double distance) {
  const double at_least = (p_W - shape.T_W_O.translation()).norm() - shape.half_size.norm();
  return at_least >= distance ? distance : std::min(distance, SignedDistance(shape, p_W));
}

}  // namespace

double SignedDistance(const SceneObject& object, const Eigen::Vector3d& p_W) {
  double distance = kNoHit;
  for (const Shape& shape : object.shapes) distance = Nearer(shape, p_W, distance);
  return distance;
}

double SignedDistance(const Scene& scene, const Eigen::Vector3d& p_W) {
  double distance = kNoHit;
  for (const SceneObject& object : scene.objects) {
    for (const Shape& shape : object.shapes) distance = Nearer(shape, p_W, distance);
  }
  return distance;
}

Eigen::AlignedBox3d BoundingBox(const SceneObject& object) {
  Eigen::AlignedBox3d box;
  for (const Shape& shape : object.shapes) box.extend(BoundingBox(shape));
  return box;
}

const SceneObject* FindObject(const Scene& scene, uint16_t id) {
  const auto found = std::find_if(scene.objects.begin(), scene.objects.end(),
                                  [id](const SceneObject& object) { return object.id == id; });
  return found == scene.objects.end() ? nullptr : &*found;
}

Scene SceneInFrame(const Scene& scene, int64_t frame_number) {
  Scene shown{scene.name, {}};
  for (const SceneObject& object : scene.objects) {
    if (frame_number >= object.first_frame && frame_number < object.end_frame)
      shown.objects.push_back(object);
  }
  return shown;
}

}  // namespace vismap
