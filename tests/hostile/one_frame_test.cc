#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <vismap/octree_t.hpp>

#include "hostile/hostile_bus.h"
#include "hostile/hostile_frames.h"

// What single frames can do to the segmenter and to the map server.

namespace vismap::hostile {
namespace {

using ::testing::HasSubstr;

using OneFrame = HostileBus;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Intrinsics that no camera has: 5 px, as normalised ones have them, and worse.
std::vector<rgbd_frame_t> FramesOfImpossibleCameras() {
  std::vector<rgbd_frame_t> messages;
  for (const double focal : {5.0, 0.82, 1e-300, 1e9, 1e300, kNaN, -130.0, 0.0}) {
    messages.push_back(Encode(Noise(1000 + static_cast<int64_t>(messages.size()), 1)));
    messages.back().color_camera.fx = messages.back().color_camera.fy = focal;
    messages.back().depth_camera = messages.back().color_camera;
  }
  for (const double center : {1e9, -1e5, kNaN}) {
    messages.push_back(Encode(Noise(1000 + static_cast<int64_t>(messages.size()), 1)));
    messages.back().color_camera.cx = messages.back().depth_camera.cx = center;
  }
  return messages;
}

std::vector<rgbd_frame_t> FramesOfImpossiblePoses() {
  std::vector<rgbd_frame_t> messages;
  for (const double x : {1e30, 1e6, kNaN, -std::numeric_limits<double>::infinity()}) {
    messages.push_back(Encode(Wall(2000 + static_cast<int64_t>(messages.size()))));
    messages.back().T_W_C[3] = x;
  }
  return messages;
}

TEST_F(OneFrame, OfAnImpossibleCameraOrPoseIsRejectedAtOnce) {
  const auto server = Start("map-server");
  const auto segmenter = Start("depth-segmenter", "", {"--detections", "none"});
  std::vector<rgbd_frame_t> messages = FramesOfImpossibleCameras();
  for (rgbd_frame_t& message : FramesOfImpossiblePoses()) messages.push_back(message);
  const auto count = static_cast<int64_t>(messages.size());
  for (const rgbd_frame_t& message : messages) {
    bus().Publish(kRgbdFrameChannel, message);
    segmented_frame_t segmented = Segmented(Noise(message.utime, 1));
    segmented.frame = message;
    bus().Publish(kSegmentedFrameChannel, segmented);
  }
  const double start = MonotonicSeconds();
  ASSERT_TRUE(SpinUntil([&] {
    return Counter("depth-segmenter", "RGBD_FRAME.rejected") == count &&
           Counter("map-server", "SEGMENTED_FRAME.rejected") == count;
  }));
  EXPECT_LT(MonotonicSeconds() - start, 20);
  ExpectPeakBelow(200, "map-server", server->pid());
  ExpectPeakBelow(200, "depth-segmenter", segmenter->pid());
  EXPECT_EQ(Commits(frame_commit_t::STATUS_SKIPPED), count);
  EXPECT_THAT(commits_.front().reason, HasSubstr("75 degrees from its optical axis"));
  EXPECT_THAT(segmenter->StandardError(), HasSubstr("75 degrees from its optical axis"));
  bus().Publish(kSegmentedFrameChannel, Segmented(Wall(9000)));
  EXPECT_TRUE(SpinUntil([&] { return Commits(frame_commit_t::STATUS_INTEGRATED) == 1; }));
}

TEST_F(OneFrame, OfNoiseIsBoundedInTimeAndMemory) {
  const auto server =
      Start("map-server", "integration { max_map_mb: 256 max_frame_blocks: 20000 }");
  SensorFrame widest = Noise(1000, 1, 320, 240);
  widest.header.camera.fx = widest.header.camera.fy = 43.2;  // 75 degrees to each side
  const double start = MonotonicSeconds();
  bus().Publish(kSegmentedFrameChannel, Segmented(widest));
  ASSERT_TRUE(SpinUntil([&] { return commits_.size() == 1; }));
  EXPECT_LT(MonotonicSeconds() - start, 20);
  EXPECT_EQ(commits_[0].status, frame_commit_t::STATUS_SKIPPED);
  EXPECT_THAT(commits_[0].reason, HasSubstr("more than 20000 blocks"));
  ExpectPeakBelow(400, "map-server", server->pid());
}

TEST_F(OneFrame, ThatRunsAwayAgainAndAgainDoesNotFillTheMemory) {
  const auto server =
      Start("map-server", "integration { max_map_mb: 100 max_unpacked_blocks: 500 }");
  constexpr int kFrames = 400;
  for (int i = 0; i < kFrames; ++i)
    bus().Publish(kSegmentedFrameChannel, Segmented(Wall(1000 + i, {10.0 * i, 0, 0})));
  ASSERT_TRUE(SpinUntil([&] { return commits_.size() == kFrames; }));
  EXPECT_GT(Commits(frame_commit_t::STATUS_SKIPPED), 50);
  EXPECT_THAT(commits_.back().reason, HasSubstr("limit of 100 MB (integration.max_map_mb)"));
  SpinFor(1.2);
  EXPECT_GT(Counter("map-server", "frames_refused"), 50);
  EXPECT_LE(Counter("map-server", "map_bytes"), 100 << 20);
  ExpectPeakBelow(500, "map-server", server->pid());
  bus().Publish(kSegmentedFrameChannel, Segmented(Wall(500)));
  EXPECT_TRUE(SpinUntil([&] { return commits_.size() == kFrames + 1; }));
  EXPECT_EQ(commits_.back().status, frame_commit_t::STATUS_INTEGRATED) << "the map knows this wall";
}

TEST_F(OneFrame, FarFromTheOthersDoesNotTakeTheOctreeAway) {
  const auto server = Start("map-server");
  const auto exporter = Start("octomap-exporter", "octomap_exporter { period_s: 0.1 }");
  int octrees = 0;
  bus().Subscribe<octree_t>(kOctomapChannel, [&](const octree_t&) { ++octrees; });
  for (int i = 0; i < 2; ++i)
    bus().Publish(kSegmentedFrameChannel, Segmented(Wall(1000 + i, {2000, 0, 0})));
  for (int i = 0; i < 20; ++i) bus().Publish(kSegmentedFrameChannel, Segmented(Wall(2000 + i)));
  ASSERT_TRUE(SpinUntil([&] { return Commits(frame_commit_t::STATUS_INTEGRATED) == 22; }));
  EXPECT_TRUE(SpinUntil([&] { return Counter("octomap-exporter", "map_revision") == 22; }));
  octrees = 0;
  bus().Publish(kSegmentedFrameChannel, Segmented(Wall(3000)));
  EXPECT_TRUE(SpinUntil([&] { return octrees > 0; }));
  EXPECT_TRUE(SpinUntil([&] { return Counter("octomap-exporter", "octree_incomplete") == 1; }));
  EXPECT_THAT(exporter->StandardError(), HasSubstr("beyond the 1638.4 m around the origin"));
}

}  // namespace
}  // namespace vismap::hostile
