#include <map>
#include <set>

#include "base/random.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

/// For each object id: the number of its pixels, and their bounding box (inclusive).
std::map<uint16_t, std::pair<int, Eigen::AlignedBox2i>> MeasureObjects(const Image<uint16_t>& ids) {
  std::map<uint16_t, std::pair<int, Eigen::AlignedBox2i>> objects;
  for (int v = 0; v < ids.height(); ++v) {
    for (int begin = 0, end = 0; begin < ids.width(); begin = end) {
      while (end < ids.width() && ids(v, end) == ids(v, begin)) ++end;
      auto& [pixels, box] = objects[ids(v, begin)];
      pixels += end - begin;
      box.extend(Eigen::Vector2i(begin, v)).extend(Eigen::Vector2i(end - 1, v));
    }
  }
  return objects;
}

/// The classes of the objects that the detector knows, ascending.
std::vector<ClassId> KnownClasses(const Scene& scene) {
  std::set<ClassId> classes;
  for (const SceneObject& object : scene.objects) {
    if (object.kind == ObjectKind::kKnown) classes.insert(object.class_id);
  }
  return {classes.begin(), classes.end()};
}

/// A random one of the other classes, with equal probabilities; the true class if there is no
/// other.
ClassId OtherClass(const std::vector<ClassId>& classes, ClassId truth, uint64_t bits) {
  if (classes.size() < 2) return truth;
  const auto others = static_cast<double>(classes.size() - 1);
  const auto choice = static_cast<size_t>(Uniform(bits) * others);
  const bool before = classes[choice] < truth;
  return classes[before ? choice : choice + 1];
}

}  // namespace

DetectionSet SimulateDetections(const Scene& scene, const Image<uint16_t>& object_ids,
                                const FrameHeader& header, const DetectorNoise& noise) {
  DetectionSet set{header.utime, header.camera_id, header.frame_number, {}};
  const double min_pixels =
      noise.min_pixels * static_cast<double>(object_ids.size()) / (640.0 * 480.0);
  const std::vector<ClassId> classes = KnownClasses(scene);
  const uint64_t frame_key = Mix(noise.seed, static_cast<uint64_t>(header.frame_number));
  for (const auto& [id, measured] : MeasureObjects(object_ids)) {
    const auto& [pixels, box] = measured;
    const SceneObject* object = FindObject(scene, id);
    // The detector does not know the object's class, or the object is too small.
    if (object == nullptr || object->kind != ObjectKind::kKnown || pixels < min_pixels) continue;
    const uint64_t key = Mix(frame_key, id);
    if (Uniform(Mix(key, 1)) < noise.miss_rate) continue;  // missed in this frame
    Mask mask = NoisyMask(object_ids, id, box, noise.mask, key);
    if (mask.inside.empty()) continue;
    const auto score = static_cast<float>(0.6 + 0.4 * Uniform(Mix(key, 3)));
    const bool confused = Uniform(Mix(key, 9)) < noise.class_confusion;
    set.detections.push_back(
        {confused ? OtherClass(classes, object->class_id, Mix(key, 10)) : object->class_id, score,
         std::move(mask)});
  }
  return set;
}

}  // namespace vismap
