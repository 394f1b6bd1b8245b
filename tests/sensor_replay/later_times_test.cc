#include "sensor_replay/later_times.h"

#include <gtest/gtest.h>

#include "wire/pose_digest.h"

namespace vismap {
namespace {

/// Frames at 30 per second, each at another pose; they are at x = `start`, `start` + 1, ...
class Walk : public Dataset {
 public:
  Walk(double start, size_t frames) : start_(start), frames_(frames) {}
  std::string name() const override { return "walk"; }
  std::string format() const override { return "redwood"; }
  size_t size() const override { return frames_; }
  FrameHeader Header(size_t i) const override {
    FrameHeader header;
    header.utime = static_cast<int64_t>(i) * 33333;
    // All walks begin at the same place.
    header.T_W_C.translation().x() = i == 0 ? 0 : start_ + static_cast<double>(i);
    return header;
  }
  Result<SensorFrame> Read(size_t) const override { return Fail("not needed"); }
  const std::vector<SkippedFrame>& skipped() const override { return skipped_; }
  std::optional<std::string> default_detections_path() const override { return std::nullopt; }

 private:
  double start_;
  size_t frames_;
  std::vector<SkippedFrame> skipped_;
};

using Frames = std::map<FrameKey, std::string>;

Frames MapOf(const Dataset& dataset, size_t frames, int64_t moved = 0) {
  Frames map;
  for (size_t i = 0; i < frames; ++i) {
    const FrameHeader header = dataset.Header(i);
    map[{header.camera_id, header.utime + moved}] = PoseDigest(header.T_W_C);
  }
  return map;
}

TEST(LaterTimes, AnEmptyMapOrOneOfAnotherCameraMovesNothing) {
  const Walk walk(0, 10);
  EXPECT_EQ(LaterTimes(walk, {}), 0);
  Frames other;
  for (const auto& [key, pose] : MapOf(Walk(100, 10), 10)) other[{CameraId{5}, key.utime}] = pose;
  EXPECT_EQ(LaterTimes(walk, other), 0);
}

TEST(LaterTimes, AnotherSequenceGoesOnAfterTheMap) {
  EXPECT_EQ(LaterTimes(Walk(100, 10), MapOf(Walk(0, 20), 20)), 20 * 33333);
  EXPECT_EQ(LaterTimes(Walk(100, 10), MapOf(Walk(0, 20), 20, 1'700'000'000'000'000)),
            1'700'000'000'000'000 + 20 * 33333);
}

TEST(LaterTimes, TheSameSequenceKeepsItsTimes) {
  const Walk walk(0, 10);
  EXPECT_EQ(LaterTimes(walk, MapOf(walk, 10)), 0);
  EXPECT_EQ(LaterTimes(walk, MapOf(walk, 4)), 0) << "it was stopped early";
  EXPECT_EQ(LaterTimes(walk, MapOf(walk, 1)), 0);
  EXPECT_EQ(LaterTimes(walk, MapOf(walk, 4, 777'000'000)), 777'000'000);
}

}  // namespace
}  // namespace vismap
