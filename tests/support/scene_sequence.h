#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sequence_mapper/map_sequence.h"
#include "simulation/simulate.h"
#include "simulation/synthetic_dataset.h"

namespace vismap::testing_support {

/// The frames that a Kinect at known poses takes of any scene.
class SceneSequence : public Dataset {
 public:
  /// Changes a frame after it was taken; `header` is the true one.
  using Change = std::function<void(const FrameHeader& header, SensorFrame*)>;

  SceneSequence(Scene scene, std::vector<FrameHeader> headers, DepthNoise noise = {},
                Change change = {})
      : scene_(std::move(scene)),
        headers_(std::move(headers)),
        noise_(noise),
        change_(std::move(change)) {}

  std::string name() const override { return scene_.name; }
  std::string format() const override { return "synthetic"; }
  size_t size() const override { return headers_.size(); }
  FrameHeader Header(size_t i) const override { return headers_[i]; }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }
  Result<SensorFrame> Read(size_t i) const override {
    const Scene shown = SceneInFrame(scene_, headers_[i].frame_number);
    SensorFrame frame = RenderFrame(shown, headers_[i], noise_);
    if (change_) change_(headers_[i], &frame);
    return frame;
  }

 private:
  Scene scene_;
  std::vector<FrameHeader> headers_;
  DepthNoise noise_;
  Change change_;
  std::vector<SkippedFrame> skipped_;
};

/// The frames of a data set after a change.
class ChangedDataset : public Dataset {
 public:
  using Change = std::function<void(SensorFrame*)>;
  ChangedDataset(const Dataset& original, Change change)
      : original_(original), change_(std::move(change)) {}

  std::string name() const override { return original_.name(); }
  std::string format() const override { return original_.format(); }
  size_t size() const override { return original_.size(); }
  FrameHeader Header(size_t i) const override { return original_.Header(i); }
  const std::vector<SkippedFrame>& skipped() const override { return original_.skipped(); }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }
  Result<SensorFrame> Read(size_t i) const override {
    Result<SensorFrame> frame = original_.Read(i);
    if (frame) change_(&*frame);
    return frame;
  }

 private:
  const Dataset& original_;
  Change change_;
};

/// Maps the first `to` frames of a data set that the map does not have yet, without detections.
inline MappedSequence MapFrames(const Dataset& dataset, const SegmentationStageOptions& stage,
                                size_t to, MapSession* session) {
  StageTimes times;
  const auto mapped = MapSequence(
      {dataset}, stage, [&](size_t done) { return done < to; }, session, &times);
  if (!mapped) throw std::runtime_error(mapped.error().message);
  return *mapped;
}

}  // namespace vismap::testing_support
