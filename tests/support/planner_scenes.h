#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "evaluation/ground_truth.h"
#include "evaluation/nearest.h"
#include "freespace/octree_reading.h"
#include "geometry/prepare_depth.h"
#include "navigation/start_clearing.h"
#include "rectify/rectifier.h"
#include "simulation/camera_path.h"
#include "simulation/sequence.h"
#include "support/planner_states.h"
#include "support/scene_sequence.h"

namespace vismap::testing_support {

/// A hall without walls: a floor of 24 x 24 m with four columns and a crate, which nothing but the
/// range of the camera bounds.
inline Scene MakeOpenHall() {
  Scene scene{"hall", {}};
  const auto add = [&](const char* name, const Eigen::Vector3d& center,
                       const Eigen::Vector3d& half_size) {
    SceneObject object{.id = static_cast<uint16_t>(scene.objects.size() + 1),
                       .name = name,
                       .kind = ObjectKind::kStructure,
                       .color = {180, 180, 180},
                       .shapes = {}};
    Shape shape{.half_size = half_size};
    shape.T_W_O.translation() = center;
    object.shapes.push_back(shape);
    scene.objects.push_back(object);
  };
  add("floor", {0, 0, -0.1}, {12, 12, 0.1});
  for (const double x : {-3.0, 3.0}) {
    for (const double y : {-2.5, 2.5}) add("column", {x, y, 2}, {0.2, 0.2, 2});
  }
  add("crate", {0.6, 3, 0.4}, {0.5, 0.4, 0.4});
  return scene;
}

/// Headers of a camera of 320x240 pixels that goes round in the middle of the hall and looks
/// outward and a little down.
inline std::vector<FrameHeader> HallHeaders(int count) {
  const PinholeCamera camera{320, 240, 262.5, 262.5, 159.5, 119.5};
  std::vector<FrameHeader> headers;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * M_PI * i / count;
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    headers.push_back({.utime = 100000 * (i + 1),
                       .camera_id = CameraId{0},
                       .frame_number = i + 1,
                       .camera = camera,
                       .T_W_C = LookAt(0.8 * out + Eigen::Vector3d(0, 0, 1.5),
                                       4 * out + Eigen::Vector3d(0, 0, 0.7))});
  }
  return headers;
}

/// A sequence with all that is true of it.
struct PlannerScene {
  std::string name;
  std::shared_ptr<const Dataset> dataset;
  PlannerTruth truth;
  /// Signed distance [m]; empty where only points of the surface are known.
  std::function<double(const Eigen::Vector3d&)> signed_distance;
};

/// Fills PlannerTruth::seen with the depth of all frames. `headers` have the true poses.
inline void AddSeen(const Dataset& dataset, const std::vector<FrameHeader>& headers,
                    SeenSpace* seen) {
  Rectifier rectifier;
  for (size_t i = 0; i < dataset.size(); ++i) {
    auto frame = rectifier.Decode(*dataset.Read(i));
    PrepareDepth({}, &frame->depth);
    seen->Add(headers[i], std::move(frame->depth));
  }
}

inline PlannerScene SyntheticPlannerScene(const std::string& path) {
  const SyntheticOptions options = *ParseSyntheticPath(path);
  PlannerScene scene;
  scene.name = path;
  scene.dataset = std::move(*OpenSequence(path, "", {}));
  const auto shapes = std::make_shared<const Scene>(MakeScene(options));
  scene.signed_distance = [shapes](const Eigen::Vector3d& p) { return SignedDistance(*shapes, p); };
  scene.truth.distance = scene.signed_distance;
  AddSeen(*scene.dataset, MakeHeaders(options), &scene.truth.seen);
  return scene;
}

inline PlannerScene HallPlannerScene() {
  const std::vector<FrameHeader> headers = HallHeaders(60);
  const auto shapes = std::make_shared<const Scene>(MakeOpenHall());
  PlannerScene scene;
  scene.name = "hall";
  scene.dataset = std::make_shared<SceneSequence>(*shapes, headers);
  scene.signed_distance = [shapes](const Eigen::Vector3d& p) { return SignedDistance(*shapes, p); };
  scene.truth.distance = scene.signed_distance;
  AddSeen(*scene.dataset, headers, &scene.truth.seen);
  return scene;
}

/// A SceneNN folder with its truth. Its points are a few centimetres apart at most, so that the
/// distance of a sphere of 20 cm is right to a millimetre or two.
inline PlannerScene RecordedPlannerScene(const std::string& path) {
  PlannerScene scene;
  scene.name = path.substr(path.size() - 3);
  scene.dataset = std::move(*OpenSequence(path, "", {}));
  const GroundTruth truth = *ReadSceneNnTruth(path);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& p : truth.points_W) points.push_back(p.cast<double>());
  for (const auto& [a, b, c] : truth.triangles) {  // makes them twice as dense
    const auto at = [&](int i) {
      return Eigen::Vector3d(truth.points_W[static_cast<size_t>(i)].cast<double>());
    };
    points.push_back((at(a) + at(b) + at(c)) / 3);
  }
  const auto nearest = std::make_shared<const NearestPoints>(std::move(points));
  scene.truth.distance = [nearest](const Eigen::Vector3d& p) {
    return nearest->Nearest(p)->distance;
  };
  std::vector<FrameHeader> headers;
  for (size_t i = 0; i < scene.dataset->size(); ++i) headers.push_back(scene.dataset->Header(i));
  AddSeen(*scene.dataset, headers, &scene.truth.seen);
  return scene;
}

/// Where the camera was, as the sequence says [m].
inline std::vector<Eigen::Vector3d> PathOf(const Dataset& dataset) {
  std::vector<Eigen::Vector3d> path_W;
  for (size_t i = 0; i < dataset.size(); ++i)
    path_W.push_back(dataset.Header(i).T_W_C.translation());
  return path_W;
}

/// The leaves, with those free that were never seen but that a sphere around the camera covered.
inline OccupancyMap WithStartCleared(OccupancyMap leaves, double radius,
                                     const std::vector<Eigen::Vector3d>& path_W) {
  const auto covered = CoveredUnknownLeaves(leaves, {radius, 0, 0}, path_W);
  for (const auto& [index, bits] : covered.value())
    leaves.Set(index, WithFreeLeaves(leaves.At(index), bits));
  return leaves;
}

/// The closed tree of leaves.
inline std::unique_ptr<octomap::OcTree> ClosedTreeOf(const OccupancyMap& leaves,
                                                     double resolution) {
  constexpr double kShell = 1;  // [m]
  const auto octree =
      EncodeOctree(leaves, resolution, UnknownPolicy::kOccupied, std::nullopt, kShell);
  return std::move(ReadOctree(octree.value().bytes, "closed").value());
}

}  // namespace vismap::testing_support
