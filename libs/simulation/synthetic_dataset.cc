#include "simulation/synthetic_dataset.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "base/require.h"
#include "rectify/rectified_camera.h"
#include "simulation/office.h"
#include "simulation/pose_drift.h"
#include "simulation/pose_noise.h"
#include "simulation/realsense.h"
#include "simulation/room.h"

namespace vismap {
namespace {

constexpr uint64_t kPoseKey =
    0x706f7365;  // separates these random numbers from the others of a frame

std::vector<Pose> DriftedPoses(const std::vector<FrameHeader>& headers,
                               const SyntheticOptions& options) {
  std::vector<Pose> T_W_C;
  for (const FrameHeader& header : headers) T_W_C.push_back(header.T_W_C);
  return AddPoseDrift(T_W_C, {options.drift, options.turn_drift});
}

class SyntheticDataset : public Dataset {
 public:
  SyntheticDataset(const SyntheticOptions& options, const DatasetOptions& selection)
      : options_(options), scene_(MakeScene(options)) {
    noise_.enabled = options.noise;
    noise_.seed = options.seed;
    noise_.scale = options.depth_noise;
    Require(selection.stride >= 1, "the stride of a data set is at least 1");
    const std::vector<FrameHeader> all = MakeHeaders(options);
    const std::vector<Pose> drifted = DriftedPoses(all, options);
    for (size_t i = 0; i < all.size(); i += static_cast<size_t>(selection.stride)) {
      if (selection.max_frames > 0 && size() == static_cast<size_t>(selection.max_frames)) break;
      drifted_.push_back(drifted[i]);
      true_headers_.push_back(all[i]);
      true_headers_.back().camera_id = selection.camera_id;
    }
  }

  std::string name() const override { return options_.scene; }
  std::string format() const override { return "synthetic"; }
  size_t size() const override { return true_headers_.size(); }
  FrameHeader Header(size_t i) const override {
    Require(i < size(), "the index of a frame is below the number of frames");
    FrameHeader header = true_headers_[i];
    header.T_W_C =
        AddPoseNoise(drifted_[i], {.deviation = options_.pose_noise},
                     Mix(Mix(options_.seed, kPoseKey), static_cast<uint64_t>(header.frame_number)));
    return header;
  }
  Result<SensorFrame> Read(size_t i) const override {
    FrameHeader given = Header(i);
    const Scene shown = SceneInFrame(scene_, given.frame_number);
    SensorFrame frame = options_.realsense ? RenderRealSense(shown, true_headers_[i], noise_)
                                           : RenderFrame(shown, true_headers_[i], noise_);
    frame.header = std::move(given);
    return frame;
  }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::optional<std::string> default_detections_path() const override {
    return SyntheticPath(options_);
  }

 private:
  SyntheticOptions options_;
  Scene scene_;
  DepthNoise noise_;
  std::vector<FrameHeader> true_headers_;
  std::vector<Pose> drifted_;  // of these headers
  std::vector<SkippedFrame> skipped_;
};

MaskNoise MaskNoiseOf(const SyntheticOptions& options) {
  MaskNoise noise;
  noise.max_growth = options.mask_noise.value_or(options.noise ? noise.max_growth : 0);
  noise.max_shift = std::max(noise.max_growth - MaskNoise{}.max_growth, 0);
  noise.waver = 0.5 * noise.max_shift;
  return noise;
}

DetectorNoise DetectorNoiseOf(const SyntheticOptions& options) {
  DetectorNoise noise;
  noise.seed = options.seed;
  if (!options.noise) noise.miss_rate = 0;
  if (options.detection_rate) noise.miss_rate = 1 - *options.detection_rate;
  noise.class_confusion = options.class_confusion;
  noise.mask = MaskNoiseOf(options);
  return noise;
}

class SyntheticDetections : public DetectionSource {
 public:
  explicit SyntheticDetections(const SyntheticOptions& options)
      : scene_(MakeScene(options)),
        headers_(MakeHeaders(options)),
        noise_(DetectorNoiseOf(options)),
        detect_every_(options.detect_every) {}

  Result<DetectionSet> ForFrame(const FrameHeader& header) const override {
    if (!IsOfSequence(header) || !DetectorRan(header)) {
      return DetectionSet{header.utime, header.camera_id, header.frame_number, {}};
    }
    const FrameHeader& truth = headers_[static_cast<size_t>(header.frame_number - 1)];
    if (header.camera != truth.camera) {
      return Fail("synthetic detections: expected a frame of the sequence's camera, " +
                  std::to_string(truth.camera.width) + "x" + std::to_string(truth.camera.height) +
                  ", found a frame of another camera, " + std::to_string(header.camera.width) +
                  "x" + std::to_string(header.camera.height));
    }
    const Scene shown = SceneInFrame(scene_, header.frame_number);
    return SimulateDetections(shown, RenderInstances(shown, truth.camera, truth.T_W_C), header,
                              noise_);
  }

  bool DetectorRan(const FrameHeader& header) const override {
    return !IsOfSequence(header) || (header.frame_number - 1) % detect_every_ == 0;
  }

  int64_t size() const override { return -1; }

 private:
  bool IsOfSequence(const FrameHeader& header) const {
    return header.frame_number >= 1 && header.frame_number <= static_cast<int64_t>(headers_.size());
  }

  Scene scene_;
  std::vector<FrameHeader> headers_;
  DetectorNoise noise_;
  int detect_every_;
};

// The object at its new place. It is another object of the scene, with its own id.
SceneObject Moved(const SceneObject& object, const SyntheticOptions::Change& change,
                  const Scene& scene) {
  SceneObject moved = object;
  moved.id = static_cast<uint16_t>(scene.objects.back().id + 1);
  moved.first_frame = change.frame;
  const Eigen::Vector3d by_W(change.moved->x(), change.moved->y(), 0);
  for (Shape& shape : moved.shapes) shape.T_W_O.pretranslate(by_W);
  return moved;
}

// Of the rectified frames.
PinholeCamera CameraOf(const SyntheticOptions& options) {
  if (options.realsense) return RectifiedCamera(RealSenseOptics(), true);
  const int height = options.width * 3 / 4;
  const double focal = 525.0 * options.width / 640;
  return {options.width, height, focal, focal, 0.5 * (options.width - 1), 0.5 * (height - 1)};
}

}  // namespace

Scene MakeScene(const SyntheticOptions& options) {
  Require(options.scene == "room" || options.scene == "office", "the scenes are room and office");
  Scene scene = options.scene == "room" ? MakeRoom() : MakeOffice();
  for (const SyntheticOptions::Change& change : options.changes) {
    std::optional<SceneObject> moved;
    for (SceneObject& object : scene.objects) {
      if (object.id != change.object_id) continue;
      if (change.moved) moved = Moved(object, change, scene);
      (change.appears ? object.first_frame : object.end_frame) = change.frame;
    }
    if (moved) scene.objects.push_back(std::move(*moved));
  }
  return scene;
}

std::vector<FrameHeader> MakeHeaders(const SyntheticOptions& options) {
  const PinholeCamera camera = CameraOf(options);
  std::vector<FrameHeader> headers;
  const std::vector<Pose> tour =
      options.scene == "room" ? MakeRoomTour(options.frames) : MakeOfficeWalk(options.frames);
  const size_t count = tour.size() * static_cast<size_t>(options.tours);
  headers.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const auto number = static_cast<int64_t>(i + 1);
    headers.push_back({.utime = std::llround(static_cast<double>(number) * 1e6 / options.rate),
                       .camera_id = CameraId{0},
                       .frame_number = number,
                       .camera = camera,
                       .T_W_C = tour[i % tour.size()]});
  }
  return headers;
}

std::unique_ptr<Dataset> MakeSyntheticDataset(const SyntheticOptions& options,
                                              const DatasetOptions& selection) {
  return std::make_unique<SyntheticDataset>(options, selection);
}

std::unique_ptr<DetectionSource> MakeSyntheticDetections(const SyntheticOptions& options) {
  return std::make_unique<SyntheticDetections>(options);
}

}  // namespace vismap
