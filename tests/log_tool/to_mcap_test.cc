#include "log_tool/to_mcap.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <vismap/navigation_status_t.hpp>
#include <vismap/process_status_t.hpp>

#include "base/base64.h"
#include "base/file.h"
#include "codecs/frame_codec.h"
#include "freespace/octree.h"
#include "support/log_builder.h"
#include "support/mutations.h"
#include "wire/grid_message.h"
#include "wire/map_update.h"
#include "wire/mesh_update.h"
#include "wire/object_list.h"
#include "wire/octree_message.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr int64_t kFirstEvent = 1'700'000'000'010'000;  // of LogBuilder [us]

Result<McapExport> Export(const std::filesystem::path& log, const std::filesystem::path& out,
                          const McapExportOptions& options = {}) {
  Result<LogReader> reader = LogReader::Open(log);
  EXPECT_TRUE(reader) << reader.error().message;
  return WriteMcap(*reader, options, out);
}

SegmentedFrame OneSegment(int64_t utime) {
  SegmentedFrame segmented;
  segmented.frame = *DecodeFrame(SmallSensorFrame(utime));
  segmented.image.index =
      Image<SegmentIndex>(kSmallCamera.width, kSmallCamera.height, SegmentIndex::kNone);
  for (int u = 0; u < 10; ++u) segmented.image.index(5, u) = SegmentIndex{0};
  segmented.image.segment_count = 1;
  segmented.segments.resize(1);
  segmented.segments[0].pixels = 10;
  return segmented;
}

MeshUpdate SurfaceUpdate(int64_t base, int64_t revision) {
  MeshUpdate update;
  update.utime = 1000 * revision;
  update.map_id = "map-1";
  update.base_revision = base;
  update.full = base < 0;
  update.block_size = 0.16;
  BlockMesh block{{static_cast<int32_t>(revision), 0, -1}, {}};
  block.mesh.vertices.resize(3);
  for (size_t i = 0; i < 3; ++i) {
    block.mesh.vertices[i].position_W = {0.16F * static_cast<float>(revision),
                                         0.04F * static_cast<float>(i), -0.1F};
    block.mesh.vertices[i].normal_W = {0, 0, 1};
    block.mesh.vertices[i].color = {255, 0, 51};
  }
  block.mesh.triangles.push_back({0, 1, 2});
  update.mesh = {revision, {block}};
  return update;
}

MapUpdate SpaceUpdate() {
  MapUpdate update{1000, "map-1", 1, -1, 0, 1, {0.05, true, {}}};
  update.delta.blocks.emplace_back(BlockIndex{0, 0, 0}, BlockOccupancy(CellState::kFree));
  update.delta.blocks.emplace_back(BlockIndex{1, 0, 0}, BlockOccupancy(CellState::kOccupied));
  return update;
}

ObjectList OneChair() {
  ObjectSummary chair;
  chair.instance = InstanceId{7};
  chair.class_id = ClassId{62};
  chair.class_probability = {{ClassId{62}, 1.0}};
  chair.score = 0.75;
  chair.segments = {SegmentLabel{4}};
  chair.points = 100;
  chair.box.center_W = {1, 2, 0.5};
  chair.box.size = {0.5, 0.625, 0.75};
  return {2000, "map-1", 2, {chair}};
}

GridMessage OneCell() {
  GridMessage message{2000, 2500, "map-1", 2, {}, {}};
  message.grid.resolution_m = 0.05;
  message.grid.width = message.grid.height = 1;
  message.grid.states = {CellState::kFree};
  message.grid.distances_m = {0.025F};
  message.grid.floor_m = {0};
  return message;
}

process_status_t StatusOf(const std::string& source, const std::string& message) {
  process_status_t status{};
  status.utime = 3000;
  status.source = source;
  status.state = "running";
  status.message = message;
  status.counter_names = {"frames"};
  status.counter_values = {5};
  status.n_counters = 1;
  return status;
}

/// A log with a message of every kind that has a counterpart.
std::string WholeRun(LogBuilder* builder) {
  builder->Frame(1000).Detections(1000);  // events 0, 1
  builder->Add(kSegmentedFrameChannel, Encode(OneSegment(1000), Encode(SmallSensorFrame(1000))));
  builder->Commit(1000, 1).Add(kMeshDeltaChannel, Encode(SurfaceUpdate(-1, 1)));  // 3, 4
  builder->Add(kMapDeltaChannel, Encode(SpaceUpdate()));
  builder->Frame(1000).Frame(2000).Add(kMeshDeltaChannel, Encode(SurfaceUpdate(1, 2)));  // 6..8
  builder->Add(kObjectsChannel, Encode(OneChair(), ClassName));
  builder->Add(kGridChannel, Encode(OneCell())).Add(kGridChannel, Encode(OneCell()));
  builder->Add(kStatusChannel, StatusOf("map-server", ""), "map-server");
  builder->Add(kStatusChannel, StatusOf("map-server", ""), "map-server");
  builder->Add(kStatusChannel, StatusOf("map-server", "the disk is full"), "map-server");
  builder->Add(kNavigationChannel, navigation_status_t{}).AddBytes("OTHER", {1, 2, 3});
  return builder->Finish();
}

TEST(WriteMcap, CountsWhatItWritesAndWhatItLeavesOut) {
  LogBuilder builder;
  const auto result = Export(WholeRun(&builder), builder.folder() / "run.mcap");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->topics, (std::map<std::string, int64_t>{{"/camera3/color/calibration", 2},
                                                            {"/camera3/color/image", 2},
                                                            {"/camera3/depth/calibration", 2},
                                                            {"/camera3/depth/image", 2},
                                                            {"/camera3/detections", 1},
                                                            {"/camera3/path", 2},
                                                            {"/camera3/pose", 2},
                                                            {"/camera3/segments/calibration", 1},
                                                            {"/camera3/segments/image", 1},
                                                            {"/log", 2},
                                                            {"/map/commits", 1},
                                                            {"/map/free", 1},
                                                            {"/map/grid", 1},
                                                            {"/map/objects", 1},
                                                            {"/map/occupied", 1},
                                                            {"/map/surface", 2},
                                                            {"/map/surface_points", 2},
                                                            {"/status/map-server", 3},
                                                            {"/tf", 2}}));
  EXPECT_EQ(result->repeated, 2);  // a frame and a grid
  EXPECT_EQ(result->without_counterpart,
            (std::map<std::string, int64_t>{{"NAVIGATION", 1}, {"OTHER", 1}}));
  EXPECT_EQ(result->unusable.total(), 0);
  EXPECT_THAT(result->remarks, IsEmpty());
  EXPECT_EQ(result->bytes, std::filesystem::file_size(builder.folder() / "run.mcap"));
}

nlohmann::json Fact(const std::string& topic, int at, nlohmann::json path, nlohmann::json value) {
  return {{"topic", topic}, {"at", at}, {"path", std::move(path)}, {"value", std::move(value)}};
}

nlohmann::json FactsOfTheRun() {
  const SensorFrame frame = SmallSensorFrame(1000);
  const Eigen::Quaterniond rotation(frame.header.T_W_C.linear());
  nlohmann::json facts = {
      Fact("/camera3/pose", 0, {"log_us"}, kFirstEvent),
      Fact("/camera3/pose", 1, {"log_us"}, kFirstEvent + 70'000),
      Fact("/camera3/pose", 1, {"publish_us"}, 2000),
      Fact("/camera3/pose", 0, {"message", "pose", "position", "y"}, 2),
      Fact("/tf", 0, {"message", "parent_frame_id"}, "world"),
      Fact("/tf", 0, {"message", "child_frame_id"}, "camera3"),
      Fact("/tf", 0, {"message", "translation", "z"}, 3),
      Fact("/tf", 0, {"message", "rotation", "y"}, rotation.y()),
      Fact("/tf", 0, {"message", "rotation", "w"}, rotation.w()),
      Fact("/camera3/color/image", 0, {"message", "format"}, "jpeg"),
      Fact("/camera3/depth/image", 0, {"message", "encoding"}, "16UC1"),
      Fact("/camera3/color/calibration", 0, {"message", "K"}, {52, 0, 31.5, 0, 52, 23.5, 0, 0, 1}),
      Fact("/camera3/detections", 0, {"message", "texts", 0, "text"}, "chair 0.75"),
      Fact("/camera3/segments/image", 0, {"message", "format"}, "png"),
      Fact("/map/objects", 0, {"message", "entities", 0, "id"}, "object 7"),
      Fact("/map/objects", 0, {"message", "entities", 0, "cubes", 0, "size", "y"}, 0.625),
      Fact("/map/objects", 0, {"message", "entities", 0, "cubes", 0, "pose", "position", "x"}, 1),
      Fact("/map/surface", 0, {"message", "deletions", 0, "type"}, "ALL"),
      Fact("/map/surface", 0, {"message", "entities", 0, "id"}, "1/0/-1"),
      Fact("/map/surface", 1, {"message", "entities", 0, "id"}, "2/0/-1"),
      Fact("/map/surface", 0, {"message", "entities", 0, "triangles", 0, "indices"}, {0, 1, 2}),
      Fact("/map/surface_points", 0, {"message", "point_stride"}, 28),
      Fact("/map/grid", 0, {"message", "column_count"}, 1),
      Fact("/map/commits", 0, {"message", "map_id"}, "map-1"),
      Fact("/status/map-server", 0, {"message", "counters", "frames"}, 5),
      Fact("/log", 0, {"message", "message"}, "running"),
      Fact("/log", 1, {"message", "message"}, "running: the disk is full"),
      Fact("/log", 1, {"message", "level"}, "WARNING")};
  nlohmann::json image = Fact("/camera3/color/image", 0, {"message", "data"}, nullptr);
  image["base64"] = Base64(frame.color);
  facts.push_back(image);
  return facts;
}

// A reader that others wrote finds in the file what the log says.
TEST(WriteMcap, McapCoreReadsWhatTheLogSays) {
  const std::string source = VISMAP_SOURCE_DIR;
  if (std::system("command -v node >/dev/null") != 0 ||
      !std::filesystem::exists(source + "/procs/viewer/page/node_modules/@mcap/core"))
    GTEST_SKIP()
        << "node or the packages of the viewer's page are missing; scripts/page installs them";
  LogBuilder builder;
  const std::filesystem::path out = builder.folder() / "run.mcap";
  const auto result = Export(WholeRun(&builder), out);
  ASSERT_TRUE(result) << result.error().message;
  const nlohmann::json expected{{"counts", result->topics}, {"facts", FactsOfTheRun()}};
  builder.folder().Write("expected.json", expected.dump());
  const std::string read = "node " + source + "/tests/log_tool/read_mcap.mjs " + out.string() +
                           " " + (builder.folder() / "expected.json").string();
  EXPECT_EQ(std::system(read.c_str()), 0) << read;
}

OctreeMessage RawTree() {
  OccupancyMap map(0.05);
  map.Set({0, 0, 0}, BlockOccupancy(CellState::kFree));
  OctreeMessage tree;
  tree.map_id = "map-1";
  tree.voxel_size = 0.05;
  OctreeOptions options;
  options.resolution_m = 0.1;
  tree.octree = *BuildOctree(map, options);
  return tree;
}

TEST(WriteMcap, TreesGiveFreeSpaceWhereTheLogHasNoUpdatesOfIt) {
  LogBuilder builder;
  builder.Add(kOctomapRawChannel, Encode(RawTree())).Add(kOctomapRawChannel, Encode(RawTree()));
  const auto result = Export(builder.Finish(), builder.folder() / "run.mcap");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_THAT(result->topics, Contains(Pair("/map/free", 1)));
  EXPECT_EQ(result->repeated, 1);
}

TEST(WriteMcap, APartOfALogHasTheMapFromItsBeginning) {
  LogBuilder builder;
  McapExportOptions options;
  options.cut.from = 0.075;  // after the first surface
  const auto result = Export(WholeRun(&builder), builder.folder() / "run.mcap", options);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->topics.at("/map/surface"), 1);
  EXPECT_EQ(result->topics.at("/map/free"), 1);
  EXPECT_FALSE(result->topics.contains("/camera3/pose"));
  EXPECT_THAT(result->remarks, IsEmpty());
}

TEST(WriteMcap, TreesGiveFreeSpaceWhereItsUpdatesAreNotAmongTheNamedChannels) {
  LogBuilder builder;
  builder.Add(kMapDeltaChannel, Encode(SpaceUpdate())).Add(kOctomapRawChannel, Encode(RawTree()));
  McapExportOptions options;
  options.cut.channels = {"OCTOMAP_RAW"};
  const auto result = Export(builder.Finish(), builder.folder() / "run.mcap", options);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_THAT(result->topics, Contains(Pair("/map/free", 1)));
}

TEST(WriteMcap, OnlyTheChannelsThatAreNamed) {
  LogBuilder builder;
  McapExportOptions options;
  options.cut.channels = {"OBJECTS", "STATUS"};
  const auto result = Export(WholeRun(&builder), builder.folder() / "run.mcap", options);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->topics, (std::map<std::string, int64_t>{
                                {"/log", 2}, {"/map/objects", 1}, {"/status/map-server", 3}}));
}

TEST(WriteMcap, SaysWhereUpdatesAreMissing) {
  LogBuilder builder;
  builder.Add(kMeshDeltaChannel, Encode(SurfaceUpdate(-1, 1)));
  builder.Add(kMeshDeltaChannel, Encode(SurfaceUpdate(2, 3)));
  const auto result = Export(builder.Finish(), builder.folder() / "run.mcap");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_THAT(result->remarks,
              ::testing::ElementsAre(HasSubstr("updates of the surface are missing")));
}

TEST(WriteMcap, FailsWithoutMessagesThatHaveACounterpart) {
  LogBuilder builder;
  builder.AddBytes("OTHER", {1, 2, 3}).AddBytes("RGBD_FRAME", {1, 2, 3});
  const std::string log = builder.Finish();
  const auto result = Export(log, builder.folder() / "run.mcap");
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("has a counterpart"));
  EXPECT_THAT(result.error().message, HasSubstr("RGBD_FRAME"));
  EXPECT_FALSE(std::filesystem::exists(builder.folder() / "run.mcap"));
  EXPECT_FALSE(std::filesystem::exists(builder.folder() / "run.mcap.part"));
  EXPECT_THAT(Export(log, log).error().message, HasSubstr("the input itself"));
}

TEST(WriteMcap, LeavesNoFileWhenItIsStopped) {
  LogBuilder builder;
  Result<LogReader> reader = LogReader::Open(builder.Frame(1000).Finish());
  ASSERT_TRUE(reader) << reader.error().message;
  StopSignal stop;
  stop.Request();
  const auto written = WriteMcap(*reader, {}, builder.folder() / "run.mcap", &stop);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().message, kMcapStopped);
  EXPECT_FALSE(std::filesystem::exists(builder.folder() / "run.mcap"));
}

TEST(WriteMcap, NamesOnlySoManyOtherChannels) {
  LogBuilder builder;
  builder.Frame(1000);
  for (int i = 0; i < 300; ++i) builder.AddBytes("OTHER_" + std::to_string(i), {1});
  const auto result = Export(builder.Finish(), builder.folder() / "run.mcap");
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->without_counterpart.size(), 257u);
  EXPECT_EQ(result->without_counterpart.at("other channels"), 44);
}

TEST(WriteMcap, NoDamagedLogCrashesIt) {
  LogBuilder builder;
  const std::vector<uint8_t> good = *ReadFileBytes(WholeRun(&builder));
  const TempFolder folder;
  int written = 0, unusable = 0;
  ForEachMutation(good, 100, [&](const std::vector<uint8_t>& bad) {
    std::filesystem::remove(folder / "bad");
    folder.Write("bad", std::span<const uint8_t>(bad));
    const auto result = Export(folder / "bad", folder / "bad.mcap");
    written += result.has_value();
    unusable += result && result->unusable.total() > 0;
  });
  EXPECT_GT(written, 400);
  EXPECT_GT(unusable, 20);
}

}  // namespace
}  // namespace vismap
