#include <gmock/gmock.h>
#include <signal.h>

#include <regex>

#include "hostile/hostile_bus.h"
#include "hostile/hostile_frames.h"
#include "wire/rgbd_frame.h"

// Frames that arrive faster than they can be handled.

namespace vismap::hostile {
namespace {

using ::testing::HasSubstr;

using Overload = HostileBus;

constexpr int kFloodFrames = 150;

/// Frames of a camera with 30 Hz, each of which takes some 50 ms to map.
std::vector<segmented_frame_t> ManyFrames() {
  SensorFrame noise = Noise(0, 1, 320, 240);
  for (uint16_t& depth : noise.depth.pixels()) depth = static_cast<uint16_t>(depth / 2);
  segmented_frame_t message = Segmented(noise);
  std::vector<segmented_frame_t> messages;
  for (int i = 0; i < kFloodFrames; ++i) {
    message.utime = message.frame.utime = 1'000'000 + i * 33'333;
    messages.push_back(message);
  }
  return messages;
}

/// The number before some words in a text; 0 = there is none.
int64_t NumberBefore(const std::string& words, const std::string& text) {
  std::smatch match;
  if (!std::regex_search(text, match, std::regex("(\\d+) " + words))) return 0;
  return std::stoll(match[1]);
}

TEST_F(Overload, TheNewestFramesAreMappedWhenTheConfigSaysSo) {
  const auto server = Start(
      "map-server", "map_server { overload: NEWEST mesh_period_s: 100 objects_period_s: 100 }");
  for (const segmented_frame_t& message : ManyFrames())
    bus().Publish(kSegmentedFrameChannel, message);
  ASSERT_TRUE(SpinUntil([&] { return commits_.size() == kFloodFrames; }));
  EXPECT_EQ(commits_.back().utime, 1'000'000 + (kFloodFrames - 1) * 33'333);
  EXPECT_EQ(commits_.back().status, frame_commit_t::STATUS_INTEGRATED);
  const int64_t skipped = Commits(frame_commit_t::STATUS_SKIPPED);
  EXPECT_GT(skipped, 10);
  ASSERT_TRUE(SpinUntil([&] { return Counter("map-server", "frames_dropped") == skipped; }));
  server->Signal(SIGTERM);
  EXPECT_EQ(server->WaitForExit(), 0);
  EXPECT_THAT(server->StandardError(),
              HasSubstr("integrated " + std::to_string(kFloodFrames - skipped) + " frames"));
}

TEST_F(Overload, TheLagIsToldAndTheEndSaysWhatWasNotMapped) {
  const auto server =
      Start("map-server", "map_server { mesh_period_s: 100 objects_period_s: 100 }");
  const std::vector<segmented_frame_t> messages = ManyFrames();
  bus().Publish(kSegmentedFrameChannel, messages[0]);
  ASSERT_TRUE(SpinUntil([&] { return commits_.size() == 1; }));
  process_status_t camera{};  // has taken frames that have not arrived
  camera.process = "my-camera";
  camera.counter_names = {"newest_utime.camera0"};
  camera.counter_values = {messages[0].utime + 60'000'000};
  camera.n_counters = 1;
  bus().Publish(kStatusChannel, camera);
  ASSERT_TRUE(SpinUntil([&] { return Counter("map-server", "lag_ms") == 60'000; }));
  EXPECT_TRUE(SpinUntil([&] {
    const auto& findings = status_["map-server"].findings;
    return std::any_of(findings.begin(), findings.end(), [](const std::string& finding) {
      return finding.find("the map is 60 s behind the camera") != std::string::npos;
    });
  }));
  for (size_t i = 1; i < messages.size(); ++i) bus().Publish(kSegmentedFrameChannel, messages[i]);
  server->Signal(SIGTERM);
  EXPECT_TRUE(SpinUntil([&] { return !server->Running(); }));
  EXPECT_EQ(server->WaitForExit(), 0);
  const std::string log = server->StandardError();
  const int64_t mapped = NumberBefore("frames?; not integrated", log);
  const int64_t unhandled = NumberBefore("messages? of SEGMENTED_FRAME", log);
  EXPECT_GT(unhandled, 0);
  EXPECT_EQ(mapped + unhandled, kFloodFrames) << log;
}

TEST_F(Overload, TheSegmenterKeepsTheNewestFramesToo) {
  const auto segmenter =
      Start("depth-segmenter", "depth_segmenter { overload: NEWEST detections: NONE }");
  std::vector<int64_t> segmented;
  bus().Subscribe<segmented_frame_t>(kSegmentedFrameChannel, [&](const segmented_frame_t& message) {
    segmented.push_back(message.utime);
  });
  rgbd_frame_t frame = Encode(Noise(0, 1, 640, 480));
  for (int i = 0; i < kFloodFrames; ++i) {
    frame.utime = 1000 + i;
    bus().Publish(kRgbdFrameChannel, frame);
  }
  ASSERT_TRUE(
      SpinUntil([&] { return !segmented.empty() && segmented.back() == 1000 + kFloodFrames - 1; }));
  const auto count = static_cast<int64_t>(segmented.size());
  EXPECT_LT(count, kFloodFrames - 10);
  EXPECT_TRUE(std::is_sorted(segmented.begin(), segmented.end()));
  EXPECT_TRUE(SpinUntil(
      [&] { return Counter("depth-segmenter", "frames_dropped") == kFloodFrames - count; }));
}

}  // namespace
}  // namespace vismap::hostile
