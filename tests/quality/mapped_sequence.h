#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "exports/outputs.h"
#include "sequence_mapper/map_sequence.h"
#include "simulation/scene.h"
#include "simulation/sequence.h"

namespace vismap::testing_support {

/// A map with voxels of 2 cm, its mesh and its objects.
struct Mapped {
  MapSession session = MapSession(Options(), MapMetadata());
  MapProducts products;

  static MapSessionOptions Options() {
    MapSessionOptions options;
    options.grid = VoxelGridOptions{0.02, 4.0};
    return options;
  }
};

/// Maps `frames` frames of a computed sequence, and computes mesh and objects. `detections` =
/// nullptr: those of the sequence.
inline void Continue(const std::string& name, const DetectionSource* detections, size_t frames,
                     Mapped* mapped, const SegmentationStageOptions& stage = {}) {
  const auto dataset = OpenSequence(name, "", {});
  const auto own = OpenDetections(name);
  if (!dataset || !own) throw std::runtime_error("the sequence can be opened");
  StageTimes times;
  const auto proceed = [&](size_t done) { return done < frames; };
  const auto done = MapSequence({**dataset, detections != nullptr ? detections : own->get()}, stage,
                                proceed, &mapped->session, &times);
  if (!done) throw std::runtime_error(done.error().message);
  mapped->products = MakeProducts(mapped->session.map(), mapped->session.metadata(), {});
}

inline Mapped MapAll(const std::string& name, const DetectionSource* detections = nullptr) {
  Mapped mapped;
  Continue(name, detections, SIZE_MAX, &mapped);
  return mapped;
}

/// How a mesh shows one true object: the instance, or the segment without an instance, of most
/// vertices on the object's surface, and their share. These vertices are within 2 cm of the object
/// and farther than 4 cm from all others.
struct Seen {
  InstanceId instance = InstanceId::kNone;
  SegmentLabel segment = SegmentLabel::kNone;  ///< set only without an instance
  ClassId class_id = ClassId::kUnknown;
  int vertices = 0;
  double share = 0;
};

/// Finds the object with this id in a mesh.
inline Seen FindInMesh(const Scene& scene, uint16_t id, const Mesh& mesh) {
  Scene others = scene;
  std::erase_if(others.objects, [&](const SceneObject& o) { return o.id == id; });
  const SceneObject& object = *FindObject(scene, id);
  std::map<std::pair<InstanceId, SegmentLabel>, std::pair<int, ClassId>> counts;
  Seen seen;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Eigen::Vector3d p = vertex.position_W.cast<double>();
    if (std::abs(SignedDistance(object, p)) > 0.02 || SignedDistance(others, p) < 0.04) continue;
    const bool discovered = vertex.instance == InstanceId::kNone;
    auto& [count, class_id] =
        counts[{vertex.instance, discovered ? vertex.segment : SegmentLabel::kNone}];
    ++count;
    class_id = vertex.class_id;
    ++seen.vertices;
  }
  int most = 0;
  for (const auto& [key, value] : counts) {
    if (value.first <= most) continue;
    most = value.first;
    seen.instance = key.first;
    seen.segment = key.second;
    seen.class_id = value.second;
    seen.share = static_cast<double>(most) / seen.vertices;
  }
  return seen;
}

/// The detections of a sequence, changed by a function in every frame.
class ChangedDetections : public DetectionSource {
 public:
  using Change = std::function<void(const FrameHeader&, DetectionSet*)>;
  ChangedDetections(const std::string& name, Change change)
      : own_(std::move(*OpenDetections(name))), change_(std::move(change)) {}

  Result<DetectionSet> ForFrame(const FrameHeader& header) const override {
    Result<DetectionSet> set = own_->ForFrame(header);
    if (set) change_(header, &*set);
    return set;
  }
  bool DetectorRan(const FrameHeader& header) const override { return own_->DetectorRan(header); }
  int64_t size() const override { return -1; }

 private:
  std::unique_ptr<DetectionSource> own_;
  Change change_;
};

}  // namespace vismap::testing_support
