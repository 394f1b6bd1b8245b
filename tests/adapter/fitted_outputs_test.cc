#include "adapter/fitted_outputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vismap/foreign/drake/lcmt_point_cloud.hpp>
#include <vismap/foreign/drake/lcmt_viewer_link_data.hpp>
#include <vismap/foreign/nav_msgs/OccupancyGrid.hpp>
#include <vismap/foreign/robotlocomotion/viewer2_comms_t.hpp>
#include <vismap/foreign/sensor_msgs/PointCloud2.hpp>
#include <vismap/foreign/vision_msgs/Detection3DArray.hpp>

#include "runtime/bus.h"
#include "runtime/status.h"
#include "wire/channels.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr size_t kMost = 300'000;  // [bytes]

/// A floor of `side` x `side` vertices, 5 cm apart.
Mesh FloorOf(int side, SegmentLabel label) {
  Mesh mesh;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      MeshVertex vertex;
      vertex.position_W = {0.05F * static_cast<float>(x) + 0.01F,
                           0.05F * static_cast<float>(y) + 0.01F, 0.01F};
      vertex.segment = label;
      mesh.vertices.push_back(vertex);
      const auto at = static_cast<uint32_t>(y * side + x), row = static_cast<uint32_t>(side);
      if (x == 0 || y == 0) continue;
      mesh.triangles.push_back({at, at - 1, at - row});
      mesh.triangles.push_back({at - 1, at - row - 1, at - row});
    }
  }
  return mesh;
}

std::vector<ObjectSummary> ObjectsOf(int count) {
  std::vector<ObjectSummary> objects(static_cast<size_t>(count));
  for (size_t i = 0; i < objects.size(); ++i) {
    objects[i].segments = {SegmentLabel{static_cast<uint32_t>(i + 1)}};
    objects[i].box.size = {1, 1, 1};
  }
  return objects;
}

OccupancyMap SpaceOf(int blocks) {
  OccupancyMap space(0.05);
  space.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  space.Set({blocks, blocks, 0}, BlockOccupancy(CellState::kFree));
  return space;
}

AdapterOptions AllOutputs() {
  AdapterOptions options;
  options.root = "world";
  options.cloud_channel = "cloud";
  options.costmap_channel = "costmap";
  options.detections_channel = "detections";
  options.drake_cloud_channel = "drake_cloud";
  options.drake_objects_channel = "objects";
  options.director_channel = "director";
  return options;
}

/// Outputs, and the newest message of each channel.
struct Outputs {
  explicit Outputs(const AdapterOptions& options)
      : outputs(options, kMost, &report,
                [this](const std::string& channel, std::span<const uint8_t> bytes) {
                  if (!connected) return false;
                  sent[channel].assign(bytes.begin(), bytes.end());
                  EXPECT_LE(bytes.size(), kMost) << channel;
                  return true;
                }) {}
  template <typename Message>
  Message Read(const std::string& channel) const {
    const Result<Message> message = Unpack<Message>(sent.at(channel), kMost);
    EXPECT_TRUE(message) << channel;
    return *message;
  }

  bool connected = true;
  std::map<std::string, std::vector<uint8_t>> sent;
  OutputReport report;
  FittedOutputs outputs;
};

TEST(FittedOutputs, OfASmallMapHaveTheSpacingThatIsWanted) {
  Outputs outputs(AllOutputs());
  outputs.outputs.PublishSurface(FloorOf(20, SegmentLabel{1}), 5, ObjectsOf(2), 5);
  outputs.outputs.PublishSpace(SpaceOf(3), 5);
  EXPECT_EQ(outputs.sent.size(), 6u);
  EXPECT_EQ(outputs.Read<foreign::sensor_msgs::PointCloud2>("cloud").width, 400);
  EXPECT_NEAR(outputs.Read<foreign::nav_msgs::OccupancyGrid>("costmap").info.resolution, 0.05,
              1e-6);
  EXPECT_THAT(outputs.report.findings(), IsEmpty());
}

TEST(FittedOutputs, OfALargeMapAreCoarserAndSayItOnce) {
  Outputs outputs(AllOutputs());
  const Mesh mesh = FloorOf(400, SegmentLabel{1});  // 2.5 MB of points
  for (int i = 0; i < 2; ++i) {
    outputs.sent.clear();
    outputs.outputs.PublishSurface(mesh, 5, ObjectsOf(2), 5);
    outputs.outputs.PublishSpace(SpaceOf(200), 5);
    EXPECT_EQ(outputs.sent.size(), 6u);
    const auto cloud = outputs.Read<foreign::sensor_msgs::PointCloud2>("cloud");
    EXPECT_GT(cloud.data.size(), kMost / 3) << "no coarser than needed";
    EXPECT_EQ(outputs.Read<foreign::drake::lcmt_point_cloud>("drake_cloud").width, cloud.width);
    const auto link = outputs.Read<foreign::drake::lcmt_viewer_link_data>("objects");
    ASSERT_EQ(link.num_geom, 3) << "the surface of one object, and two boxes";
    EXPECT_GT(link.geom[0].float_data[1], 1000) << "triangles";
    EXPECT_GT(outputs.Read<foreign::robotlocomotion::viewer2_comms_t>("director").data.size(),
              kMost / 3);
    const auto grid = outputs.Read<foreign::nav_msgs::OccupancyGrid>("costmap");
    EXPECT_GT(grid.info.resolution, 0.1);
    EXPECT_GT(grid.data.size(), kMost / 2);
    EXPECT_EQ(outputs.report.findings().size(), 5u);
  }
  EXPECT_THAT(outputs.report.findings(),
              ::testing::Contains(::testing::AllOf(
                  HasSubstr("the spacing on cloud is "), HasSubstr(" cm instead of 5.0 cm"),
                  HasSubstr("adapter.cloud_spacing_m"), HasSubstr("a message on this bus may"))));
}

TEST(FittedOutputs, OfAMapThatShrinksAreFineAgain) {
  Outputs outputs(AllOutputs());
  outputs.outputs.PublishSurface(FloorOf(400, SegmentLabel{1}), 5, {}, 5);
  for (int i = 0; i < 40; ++i)
    outputs.outputs.PublishSurface(FloorOf(20, SegmentLabel{1}), 6, {}, 6);
  EXPECT_EQ(outputs.Read<foreign::sensor_msgs::PointCloud2>("cloud").width, 400);
  EXPECT_THAT(outputs.report.findings(), IsEmpty());
}

TEST(FittedOutputs, LeaveObjectsOutThatNoMessageHolds) {
  Outputs outputs(AllOutputs());
  outputs.outputs.PublishSurface(FloorOf(20, SegmentLabel{1}), 5, ObjectsOf(1000), 5);
  EXPECT_EQ(outputs.Read<foreign::vision_msgs::Detection3DArray>("detections").detections_length,
            static_cast<int>(kMost / 2048));
  EXPECT_THAT(outputs.report.findings(),
              ::testing::Contains(HasSubstr("854 objects are left out for other programs")));
}

TEST(FittedOutputs, SayWhatWasNotSent) {
  Outputs outputs(AllOutputs());
  outputs.connected = false;
  outputs.outputs.PublishSpace(SpaceOf(3), 5);
  EXPECT_THAT(outputs.report.findings(),
              ::testing::ElementsAre(HasSubstr("the last message for costmap was not sent")));
  outputs.connected = true;
  outputs.outputs.PublishSpace(SpaceOf(3), 5);
  EXPECT_THAT(outputs.report.findings(), IsEmpty());
}

TEST(FittedOutputs, EndSoonWhenTheProcessIsStopped) {
  OutputReport report;
  int sent = 0;
  FittedOutputs outputs(
      AllOutputs(), kMost, &report,
      [&](const std::string&, std::span<const uint8_t>) { return ++sent > 0; },
      [&] { return sent >= 2; });
  outputs.PublishSurface(FloorOf(20, SegmentLabel{1}), 5, {}, 5);
  EXPECT_EQ(sent, 3) << "the two clouds, and the short list of objects";
}

TEST(LargestOutput, IsSmallerWithoutAHub) {
  const std::string udpm = "udpm://239.255.76.67:7667?ttl=0";
  EXPECT_EQ(LargestOutput(*ParseLcmUrl(udpm)), size_t{2} << 20) << "ours have buffers of 4 MB";
  EXPECT_EQ(LargestOutput(*ParseLcmUrl(udpm + "&recv_buf_size=1000000")), 500'000U);
  EXPECT_EQ(LargestOutput(*ParseLcmUrl(udpm + "&recv_buf_size=67108864")), size_t{8} << 20);
  EXPECT_EQ(LargestOutput(*ParseLcmUrl("tcpq://127.0.0.1:7700")), kMaxMessageBytes);
}

TEST(OutputReport, HandsOnWhatTheThreadHasThrown) {
  const Result<std::unique_ptr<Bus>> bus = Bus::Open({"memq://", "test", 1});
  ASSERT_TRUE(bus);
  Status status(bus->get(), "test");
  OutputReport report;
  report.Count("published");
  report.SetFinding("a", "something is wrong");
  report.SetFinding("b", "");
  report.MoveTo(&status);
  EXPECT_EQ(status.counter("published"), 1);
  EXPECT_THAT(status.findings(), ::testing::ElementsAre("something is wrong"));
  report.Fail(std::make_exception_ptr(std::runtime_error("out of memory")));
  EXPECT_THROW(report.MoveTo(&status), std::runtime_error);
}

}  // namespace
}  // namespace vismap
