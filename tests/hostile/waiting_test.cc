#include <gmock/gmock.h>

#include <vismap/detections_t.hpp>
#include <vismap/map_delta_t.hpp>

#include "codecs/color_codec.h"
#include "hostile/hostile_bus.h"
#include "hostile/hostile_frames.h"
#include "wire/map_update.h"

// Messages that make processes wait for others that never come.

namespace vismap::hostile {
namespace {

using ::testing::HasSubstr;

using Waiting = HostileBus;

TEST_F(Waiting, FramesWhosePredecessorsNeverComeTakeNoRoomFromOthers) {
  const auto server = Start("map-server", "map_server { max_wait_s: 2 queue_mb: 8 }");
  segmented_frame_t message = Segmented(Noise(1, 7));
  for (int i = 0; i < 2000; ++i) {
    message.utime = message.frame.utime = 1'000'000 + 2 * i;
    message.frame.after_utime = message.utime - 1;
    message.frame.camera_id = 1 + i % 5;
    bus().Publish(kSegmentedFrameChannel, message);
  }
  for (int i = 0; i < 10; ++i)  // in order, each after the one before
    bus().Publish(kSegmentedFrameChannel, Segmented(Wall(100 + i), i == 0 ? -1 : 99 + i));
  ASSERT_TRUE(SpinUntil([&] { return Commits(frame_commit_t::STATUS_INTEGRATED) == 10; }));
  ASSERT_TRUE(SpinUntil([&] { return Counter("map-server", "held_frames_dropped") == 2000; }));
  EXPECT_EQ(Counter("map-server", "frames_held"), 0);
  ExpectPeakBelow(200, "map-server", server->pid());
  EXPECT_THAT(server->StandardError(), HasSubstr("the frame before did not come within 2 s"));
}

TEST_F(Waiting, LargeFramesAndDetectionsThatFindNoPartnerAreBoundedInBytes) {
  const auto segmenter =
      Start("depth-segmenter", "depth_segmenter { queue_mb: 16 detections: REQUIRED }");
  rgbd_frame_t frame = Encode(Wall(1));
  frame.source = "a";
  frame.color_encoding = rgbd_frame_t::COLOR_JPEG;
  frame.color = EncodeJpeg(Image<Rgb8>(160, 120));
  frame.color.resize(2'000'000);  // bytes after the end of the image
  frame.color_size = static_cast<int32_t>(frame.color.size());
  detections_t detections{};
  detections.image_width = 4000;
  detections.image_height = 4000;
  detections.detections.resize(1);
  detections.detections[0].runs.assign(200'000, 80);
  detections.detections[0].n_runs = 200'000;
  detections.n_detections = 1;
  for (int i = 0; i < 100; ++i) {
    frame.utime = 1000 + i;
    bus().Publish(kRgbdFrameChannel, frame);
    detections.utime = 5000 + i;
    bus().Publish(kDetectionsChannel, detections);
  }
  ASSERT_TRUE(SpinUntil([&] { return Counter("depth-segmenter", "frames_dropped") > 80; }));
  ASSERT_TRUE(SpinUntil([&] { return Counter("depth-segmenter", "detections_dropped") > 80; }));
  EXPECT_LE(Counter("depth-segmenter", "waiting_bytes"), 16 << 20);
  ExpectPeakBelow(300, "depth-segmenter", segmenter->pid());
}

/// A snapshot of 65536 blocks of which every one needs a place of its own; it takes few bytes.
map_delta_t ScatteredBlocks(int part, int parts, int64_t revision) {
  MapUpdate update;
  update.map_id = "m";
  update.revision = revision;
  update.part = part;
  update.parts = parts;
  update.delta.voxel_size = 0.01;
  update.delta.complete = true;
  for (int i = 0; i < kMaxBlocksPerUpdate; ++i)
    update.delta.blocks.emplace_back(BlockIndex{part, 4 * i, 0}, BlockOccupancy(CellState::kFree));
  return Encode(update);
}

TEST_F(Waiting, HalfUpdatesDoNotFillTheMemoryOfTheExporter) {
  const auto exporter = Start("octomap-exporter", "octomap_exporter { max_map_mb: 64 }");
  map_delta_t half = ScatteredBlocks(0, 2'000'000'000, 1);
  EXPECT_LT(half.payload.size(), 100'000u);
  for (int i = 0; i < 300; ++i) {  // parts of one update that is never complete
    half.part = i;
    bus().Publish(kMapDeltaChannel, half);
  }
  map_delta_t small = half;
  MapUpdate empty;
  empty.delta.voxel_size = 0.01;
  empty.delta.complete = true;
  empty.parts = 2;
  empty.map_id = "m";
  small = Encode(empty);
  for (int i = 0; i < 10'000; ++i) {  // and ten thousand updates of which half is missing
    small.revision = 10 + i;
    bus().Publish(kMapDeltaChannel, small);
  }
  ASSERT_TRUE(
      SpinUntil([&] { return Counter("octomap-exporter", "MAP_DELTA.received") == 10'300; }));
  EXPECT_GT(Counter("octomap-exporter", "updates_too_large"), 5);
  ExpectPeakBelow(400, "octomap-exporter", exporter->pid());
  bus().Publish(kMapDeltaChannel, ScatteredBlocks(0, 1, 20'000));  // complete, but too large
  ASSERT_TRUE(SpinUntil(
      [&] { return status_["octomap-exporter"].message.find("max_map_mb") != std::string::npos; }));
  ExpectPeakBelow(400, "octomap-exporter", exporter->pid());
}

}  // namespace
}  // namespace vismap::hostile
