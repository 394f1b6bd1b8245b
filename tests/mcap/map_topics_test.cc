#include "mcap/map_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mcap/frame_topics.h"
#include "support/messages.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;

/// A file, and topics that write to it.
struct TopicBench {
  TempFolder folder;
  FoxgloveFile file = *FoxgloveFile::Create(folder / "a.mcap");
  int64_t Count(const std::string& topic) const {
    const auto found = file.counts().find(topic);
    return found == file.counts().end() ? 0 : found->second;
  }
};

BlockMesh Surface(int x, size_t vertices = 3) {
  BlockMesh block{{x, 0, 0}, {}};
  block.mesh.vertices.resize(vertices);
  block.mesh.triangles.push_back({0, 1, 2});
  return block;
}

mesh_delta_t MeshMessage(int64_t base, int64_t revision, std::vector<BlockMesh> blocks,
                         const std::string& map_id = "map") {
  MeshUpdate update;
  update.map_id = map_id;
  update.base_revision = base;
  update.full = base < 0;
  update.block_size = 0.16;
  update.mesh = {revision, std::move(blocks)};
  return Encode(update);
}

TEST(SurfaceTopics, WritesChangesAtMostOnceInAPeriod) {
  TopicBench bench;
  SurfaceTopics topics({1, 5}, &bench.file);
  for (int i = 0; i < 35; ++i) {  // ten per second
    topics.Set(Surface(i), i);
    topics.WriteDue(100'000 * i);
  }
  EXPECT_EQ(bench.Count("/map/surface"), 4);
  EXPECT_EQ(bench.Count("/map/surface_points"), 1);
  topics.Finish(3'400'000);
  EXPECT_EQ(bench.Count("/map/surface"), 5);
  EXPECT_EQ(bench.Count("/map/surface_points"), 2);
  topics.Finish(9'000'000);
  EXPECT_EQ(bench.Count("/map/surface"), 5);
}

TEST(SurfaceTopics, WritesOnWhenTheClockOfTheLogGoesBack) {
  TopicBench bench;
  SurfaceTopics topics({1, 5}, &bench.file);
  for (const int64_t log_us : {int64_t{900'000'000}, int64_t{100'000'000}, int64_t{100'100'000},
                               int64_t{102'000'000}, INT64_MAX, INT64_MIN, int64_t{103'000'000}}) {
    topics.Set(Surface(static_cast<int>(log_us % 1000)), 1);
    topics.WriteDue(log_us);
  }
  EXPECT_EQ(bench.Count("/map/surface"), 6) << "all but the one a tenth of a second after another";
}

TEST(SurfaceTopics, FollowsUpdatesAndWaitsAfterAGap) {
  TopicBench bench;
  SurfaceTopics topics({0, 0}, &bench.file);
  EXPECT_EQ(topics.Apply(MeshMessage(-1, 1, {Surface(0)}), 0), FollowOutcome::kApplied);
  EXPECT_EQ(topics.Apply(MeshMessage(1, 2, {Surface(1)}), 1), FollowOutcome::kApplied);
  EXPECT_EQ(topics.Apply(MeshMessage(3, 4, {Surface(2)}), 2), FollowOutcome::kNeedsSnapshot);
  EXPECT_EQ(topics.gaps(), 1);
  EXPECT_EQ(topics.Apply(MeshMessage(-1, 4, {Surface(2)}), 3), FollowOutcome::kApplied);
  topics.Finish(4);
  EXPECT_EQ(bench.Count("/map/surface"), 1);
}

TEST(SurfaceTopics, ForgetsASurfaceThatIsTooLarge) {
  TopicBench bench;
  MapTopicOptions options;
  options.limits.max_bytes = 100000;
  SurfaceTopics topics(options, &bench.file);
  FollowOutcome outcome = topics.Apply(MeshMessage(-1, 1, {Surface(0)}), 0);
  for (int i = 1; outcome == FollowOutcome::kApplied && i < 100; ++i)
    outcome = topics.Apply(MeshMessage(i, i + 1, {Surface(i, 200)}), i);
  EXPECT_EQ(outcome, FollowOutcome::kTooLarge);
}

TEST(SurfaceTopics, LargeUpdatesAreSplitAndLargeCloudsThinned) {
  TopicBench bench;
  MapTopicOptions options;
  options.most_points = 1000;
  SurfaceTopics topics(options, &bench.file);
  for (int i = 0; i < 5; ++i) topics.Set(Surface(i, 50000), 0);
  const uint64_t before = bench.file.bytes();
  topics.Finish(0);
  EXPECT_EQ(bench.Count("/map/surface"), 3);
  EXPECT_EQ(bench.Count("/map/surface_points"), 1);
  EXPECT_GT(bench.file.bytes(), before);
}

TEST(SpaceTopics, WritesBothStatesWhenSpaceHasChanged) {
  TopicBench bench;
  SpaceTopics topics({1, 5}, &bench.file);
  topics.WriteDue(0);
  EXPECT_EQ(bench.Count("/map/free"), 0);
  OccupancyMap map(0.02);
  map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  topics.Set(map, 5);
  topics.WriteDue(1);
  topics.WriteDue(9'000'000);
  EXPECT_EQ(bench.Count("/map/free"), 1);
  EXPECT_EQ(bench.Count("/map/occupied"), 1);
}

TEST(FrameTopics, WritesAFrameOnce) {
  TopicBench bench;
  FrameTopics topics(&bench.file);
  EXPECT_TRUE(topics.WriteFrame(SmallSensorFrame(1000), 5));
  EXPECT_FALSE(topics.WriteFrame(SmallSensorFrame(1000), 6));
  EXPECT_TRUE(topics.WriteFrame(SmallSensorFrame(1000, 4), 6));
  SensorFrame grey = SmallSensorFrame(2000, 4);
  grey.color.clear();
  EXPECT_TRUE(topics.WriteFrame(grey, 7));
  EXPECT_THAT(bench.file.counts(),
              ElementsAre(Pair("/camera3/color/calibration", 1), Pair("/camera3/color/image", 1),
                          Pair("/camera3/depth/calibration", 1), Pair("/camera3/depth/image", 1),
                          Pair("/camera3/path", 1), Pair("/camera3/pose", 1),
                          Pair("/camera4/color/calibration", 1), Pair("/camera4/color/image", 1),
                          Pair("/camera4/depth/calibration", 2), Pair("/camera4/depth/image", 2),
                          Pair("/camera4/path", 1), Pair("/camera4/pose", 2), Pair("/tf", 3)));
}

TEST(FrameTopics, OnlySoManyCamerasHaveTopics) {
  TopicBench bench;
  FrameTopics topics(&bench.file);
  for (int camera = 0; camera < 300; ++camera)
    EXPECT_TRUE(topics.WriteFrame(SmallSensorFrame(1000, camera), 1000));
  EXPECT_EQ(bench.Count("/tf"), 256);
  EXPECT_EQ(bench.Count("/camera255/pose"), 1);
  EXPECT_EQ(bench.Count("/camera256/pose"), 0);
  EXPECT_THAT(topics.Remark(), ::testing::StartsWith("44 messages of cameras were left out"));
}

TEST(FrameTopics, ADepthCameraOfItsOwnHasAFrameOfReference) {
  TopicBench bench;
  FrameTopics topics(&bench.file);
  SensorFrame frame = SmallSensorFrame(1000);
  frame.optics = FrameOptics{{kSmallCamera}, {kSmallCamera}, false, Pose::Identity()};
  topics.WriteFrame(frame, 5);
  EXPECT_EQ(bench.Count("/tf"), 2);
}

TEST(FrameTopics, APathGrowsSlowerThanItsCamera) {
  TopicBench bench;
  FrameTopics topics(&bench.file);
  SensorFrame frame = SmallSensorFrame();
  frame.color.clear();
  frame.depth = Image<uint16_t>(1, 1);
  for (int64_t i = 0; i < 20000; ++i) {  // 30 per second, for 11 minutes
    frame.header.utime = 33'333 * i;
    topics.WriteFrame(frame, 33'333 * i);
  }
  topics.Finish();
  EXPECT_LT(bench.Count("/camera3/path"), 250);
  EXPECT_GT(bench.Count("/camera3/path"), 50);
}

}  // namespace
}  // namespace vismap
