// Frames of a RealSense-like sensor (distortion, depth beside colour) map as well as those of an
// ideal camera.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "quality/mapped_sequence.h"
#include "simulation/room.h"
#include "simulation/synthetic_dataset.h"
#include "support/mesh_scores.h"

namespace vismap {
namespace {

/// What an ideal camera sees: the rectified camera of the sequence, without distortion.
class IdealSequence : public Dataset {
 public:
  explicit IdealSequence(const SyntheticOptions& options)
      : scene_(MakeScene(options)), headers_(MakeHeaders(options)) {}
  std::string name() const override { return "ideal"; }
  std::string format() const override { return "synthetic"; }
  size_t size() const override { return headers_.size(); }
  FrameHeader Header(size_t i) const override { return headers_[i]; }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }
  Result<SensorFrame> Read(size_t i) const override {
    return RenderFrame(scene_, headers_[i], {.enabled = false});
  }

 private:
  Scene scene_;
  std::vector<FrameHeader> headers_;
  std::vector<SkippedFrame> skipped_;
};

testing_support::GeometryScore MapAndScore(const Dataset& dataset) {
  MapSession session(testing_support::Mapped::Options(), {});
  StageTimes times;
  const auto mapped = MapSequence(
      {dataset}, {}, [](size_t) { return true; }, &session, &times);
  if (!mapped || mapped->frames != static_cast<int64_t>(dataset.size()))
    throw std::runtime_error("all frames are mapped");
  const Scene scene = MakeRoom();
  return testing_support::ScoreGeometry(
      MakeProducts(session.map(), session.metadata(), {}).mesh,
      [&](const Eigen::Vector3d& p_W) { return SignedDistance(scene, p_W); });
}

TEST(RealSense, MapsAsWellAsAnIdealCamera) {
  const auto options = ParseSyntheticPath("synthetic:room?camera=realsense&noise=none&frames=40");
  ASSERT_TRUE(options) << options.error().message;
  const auto recorded = MakeSyntheticDataset(*options, {});
  ASSERT_TRUE(recorded->Read(0)->optics) << "frames are as they were taken";
  const auto seen = MapAndScore(*recorded), ideal = MapAndScore(IdealSequence(*options));
  std::printf("surface: mean %.3f mm, 95 %% %.3f mm, %ld vertices; ideal camera %.3f, %.3f, %ld\n",
              1e3 * seen.mean, 1e3 * seen.p95, static_cast<long>(seen.vertices), 1e3 * ideal.mean,
              1e3 * ideal.p95, static_cast<long>(ideal.vertices));
  EXPECT_LT(seen.mean, ideal.mean + 1e-3);
  EXPECT_LT(seen.p95, ideal.p95 + 2e-3);
  EXPECT_GT(static_cast<double>(seen.vertices), 0.97 * static_cast<double>(ideal.vertices));
}

}  // namespace
}  // namespace vismap
