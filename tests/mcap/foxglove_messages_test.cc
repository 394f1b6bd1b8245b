#include <gmock/gmock.h>
#include <google/protobuf/descriptor.pb.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "codecs/png_codec.h"
#include "foxglove.pb.h"
#include "mcap/camera_messages.h"
#include "mcap/scene_messages.h"
#include "rectify/rectified_camera.h"
#include "support/messages.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

template <typename Message>
Message Parsed(const FoxgloveMessage& encoded) {
  Message message;
  EXPECT_EQ(encoded.schema, message.GetTypeName());
  EXPECT_TRUE(message.ParseFromString(encoded.bytes));
  return message;
}

template <typename Number>
Number NumberAt(const std::string& bytes, size_t offset) {
  Number value{};
  std::memcpy(&value, bytes.data() + offset, sizeof(value));
  return value;
}

/// The bytes of element `i` at a field of a cloud or grid.
template <typename Number, typename Message>
Number FieldAt(const Message& message, const std::string& name, size_t i, size_t stride) {
  for (const auto& field : message.fields())
    if (field.name() == name) return NumberAt<Number>(message.data(), i * stride + field.offset());
  ADD_FAILURE() << "there is no field " << name;
  return {};
}

TEST(FoxgloveSchemas, HaveEveryTypeThatTheyUse) {
  google::protobuf::FileDescriptorSet set;
  ASSERT_TRUE(set.ParseFromString(FoxgloveSchemas()));
  google::protobuf::DescriptorPool pool;
  for (const auto& file : set.file()) ASSERT_NE(pool.BuildFile(file), nullptr) << file.name();
  for (const char* name : {"foxglove.SceneUpdate", "foxglove.CompressedImage", "foxglove.Log"})
    EXPECT_NE(pool.FindMessageTypeByName(name), nullptr) << name;
}

TEST(CameraMessages, AJpegIsCopiedByteForByte) {
  const SensorFrame frame = SmallSensorFrame(1'500'000'250);
  const auto image = Parsed<foxglove::CompressedImage>(ColorMessage(frame, "camera3"));
  EXPECT_EQ(image.format(), "jpeg");
  EXPECT_EQ(image.frame_id(), "camera3");
  EXPECT_EQ(image.data(), std::string(frame.color.begin(), frame.color.end()));
  EXPECT_EQ(image.timestamp().seconds(), 1500);
  EXPECT_EQ(image.timestamp().nanos(), 250000);
}

TEST(CameraMessages, RawColourHasItsEncoding) {
  SensorFrame frame = SmallSensorFrame();
  for (const auto& [encoding, name, bytes] : {std::tuple{ColorEncoding::kRgb, "rgb8", 3},
                                              {ColorEncoding::kBgr, "bgr8", 3},
                                              {ColorEncoding::kRgba, "rgba8", 4},
                                              {ColorEncoding::kBgra, "bgra8", 4},
                                              {ColorEncoding::kGrey, "mono8", 1}}) {
    frame.color_encoding = encoding;
    frame.color.assign(static_cast<size_t>(64 * 48 * bytes), 7);
    const auto image = Parsed<foxglove::RawImage>(ColorMessage(frame, "c"));
    EXPECT_EQ(image.encoding(), name);
    EXPECT_EQ(image.step() * image.height(), image.data().size());
  }
}

TEST(CameraMessages, DepthIsInMillimetres) {
  SensorFrame frame = SmallSensorFrame();
  frame.depth_unit_m = 0.0002;
  frame.depth(0, 0) = 0;
  frame.depth(0, 1) = 65535;
  frame.depth(0, 2) = 7503;  // 1.5006 m
  const auto image = Parsed<foxglove::RawImage>(DepthMessage(frame, "c"));
  EXPECT_EQ(image.encoding(), "16UC1");
  EXPECT_EQ(image.width(), 64u);
  EXPECT_EQ(image.step(), 128u);
  EXPECT_EQ(NumberAt<uint16_t>(image.data(), 0), 0);
  EXPECT_EQ(NumberAt<uint16_t>(image.data(), 2), 0);
  EXPECT_EQ(NumberAt<uint16_t>(image.data(), 4), 1501);
}

TEST(CameraMessages, CalibrationsNameTheirDistortion) {
  const auto model_of = [](Distortion distortion, size_t coefficients) {
    const LensCamera camera{kSmallCamera, distortion, std::vector<double>(coefficients, 0.1)};
    const auto message = Parsed<foxglove::CameraCalibration>(CalibrationMessage(camera, 5, "c"));
    EXPECT_EQ(message.d_size(), static_cast<int>(coefficients));
    EXPECT_THAT(message.k(), ElementsAre(52, 0, 31.5, 0, 52, 23.5, 0, 0, 1));
    EXPECT_EQ(message.p_size(), 12);
    EXPECT_EQ(message.r_size(), 9);
    return message.distortion_model();
  };
  EXPECT_EQ(model_of(Distortion::kNone, 0), "");
  EXPECT_EQ(model_of(Distortion::kBrownConrady, 5), "plumb_bob");
  EXPECT_EQ(model_of(Distortion::kBrownConrady, 8), "rational_polynomial");
  EXPECT_EQ(model_of(Distortion::kEquidistant, 4), "kannala_brandt");
}

TEST(CameraMessages, DetectionsHaveOutlinesAndTexts) {
  DetectionSet set = SmallDetections();
  set.detections.push_back({ClassId{2}, 0.5F, BoxMask(3, 3, 0, 0)});  // empty
  const auto message = Parsed<foxglove::ImageAnnotations>(DetectionsMessage(set, ClassName));
  ASSERT_EQ(message.points_size(), 2);
  ASSERT_EQ(message.texts_size(), 2);
  EXPECT_EQ(message.timestamp().nanos(), 1'000'000);
  const foxglove::PointsAnnotation& outline = message.points(0);
  EXPECT_EQ(outline.type(), foxglove::PointsAnnotation::LINE_LOOP);
  std::vector<std::pair<double, double>> corners;
  for (const foxglove::Point2& point : outline.points()) corners.emplace_back(point.x(), point.y());
  EXPECT_THAT(corners, UnorderedElementsAre(Pair(10.5, 5.5), Pair(29.5, 5.5), Pair(29.5, 34.5),
                                            Pair(10.5, 34.5)));
  EXPECT_EQ(message.texts(0).text(), "chair 0.75");
}

TEST(CameraMessages, SegmentsAreAPictureInColours) {
  SegmentImage segments{Image<SegmentIndex>(4, 2, SegmentIndex::kNone), 2};
  segments.index(0, 1) = SegmentIndex{0};
  segments.index(1, 3) = SegmentIndex{1};
  const auto message = Parsed<foxglove::CompressedImage>(SegmentsMessage(segments, 5, "c"));
  EXPECT_EQ(message.format(), "png");
  const std::vector<uint8_t> bytes(message.data().begin(), message.data().end());
  const Result<Image<Rgb8>> picture = DecodeColorPng(bytes);
  ASSERT_TRUE(picture);
  EXPECT_EQ((*picture)(0, 1), StrongColor(1));
  EXPECT_EQ((*picture)(1, 3), StrongColor(2));
  EXPECT_EQ((*picture)(0, 0), Rgb8{});
}

TEST(CameraMessages, TextsOfOthersBecomeValidUtf8) {
  const auto log = Parsed<foxglove::Log>(NoteMessage(NoteLevel::kWarning, "a\xff", "b\n\xfe", 5));
  EXPECT_EQ(log.level(), foxglove::Log::WARNING);
  EXPECT_EQ(log.name(), "a\\xff");
  EXPECT_EQ(log.message(), "b\\n\\xfe");
}

BlockMesh OneTriangle(BlockIndex index) {
  BlockMesh block{index, {}};
  for (const float x : {0.0F, 1.0F, 2.0F}) {
    MeshVertex vertex;
    vertex.position_W = {x, 2 * x, 0.5F};
    vertex.color = {255, 0, 51};
    vertex.instance = InstanceId{7};
    block.mesh.vertices.push_back(vertex);
  }
  block.mesh.triangles.push_back({0, 2, 1});
  return block;
}

TEST(SceneMessages, BlocksAreEntitiesThatReplaceOrDelete) {
  const std::vector<BlockMesh> blocks{OneTriangle({1, -2, 3}), {{4, 5, 6}, {}}};
  auto update = Parsed<foxglove::SceneUpdate>(SurfaceMessage(blocks, false, Coloring::kRgb, 9));
  ASSERT_EQ(update.entities_size(), 1);
  EXPECT_EQ(update.entities(0).id(), "1/-2/3");
  EXPECT_EQ(update.entities(0).frame_id(), "world");
  EXPECT_TRUE(update.entities(0).has_lifetime());
  const foxglove::TriangleListPrimitive& list = update.entities(0).triangles(0);
  EXPECT_THAT(list.indices(), ElementsAre(0, 2, 1));
  EXPECT_EQ(list.points(2).y(), 4);
  EXPECT_EQ(list.colors(0).b(), 0.2);
  ASSERT_EQ(update.deletions_size(), 1);
  EXPECT_EQ(update.deletions(0).id(), "4/5/6");
  EXPECT_EQ(update.deletions(0).type(), foxglove::SceneEntityDeletion::MATCHING_ID);

  update = Parsed<foxglove::SceneUpdate>(SurfaceMessage(blocks, true, Coloring::kInstance, 9));
  ASSERT_EQ(update.deletions_size(), 1);
  EXPECT_EQ(update.deletions(0).type(), foxglove::SceneEntityDeletion::ALL);
  EXPECT_EQ(update.entities(0).triangles(0).colors(0).r(), StrongColor(7).r / 255.0);
}

TEST(SceneMessages, PointsHaveColoursAndIds) {
  CloudPoint point{{1, 2, 3}, {10, 20, 30}, SegmentLabel{70000}, InstanceId{80000}, ClassId{62}, 9};
  const auto cloud =
      Parsed<foxglove::PointCloud>(SurfaceCloudMessage(std::vector{CloudPoint{}, point}, 5));
  const size_t stride = cloud.point_stride();
  EXPECT_EQ(cloud.data().size(), 2 * stride);
  EXPECT_EQ(FieldAt<float>(cloud, "z", 1, stride), 3);
  EXPECT_EQ(FieldAt<uint8_t>(cloud, "green", 1, stride), 20);
  EXPECT_EQ(FieldAt<uint8_t>(cloud, "alpha", 1, stride), 255);
  EXPECT_EQ(FieldAt<uint32_t>(cloud, "segment", 1, stride), 70000u);
  EXPECT_EQ(FieldAt<uint32_t>(cloud, "instance", 1, stride), 80000u);
  EXPECT_EQ(FieldAt<uint16_t>(cloud, "class", 1, stride), 62);
  EXPECT_EQ(FieldAt<uint16_t>(cloud, "seen", 1, stride), 9);
}

TEST(SceneMessages, ObjectsAreBoxesWithTexts) {
  ObjectList list{5, "map", 3, {}};
  ObjectSummary chair;
  chair.instance = InstanceId{7};
  chair.class_id = ClassId{62};
  chair.score = 0.8;
  chair.segments = {SegmentLabel{4}, SegmentLabel{9}};
  chair.box.center_W = {1, 2, 3};
  chair.box.size = {0.5, 0.6, 0.8};
  ObjectSummary discovered;
  discovered.segments = {SegmentLabel{12}};
  ObjectSummary removed = chair;
  removed.state = ObjectState::kRemoved;
  list.objects = {chair, discovered, removed};
  const auto update = Parsed<foxglove::SceneUpdate>(ObjectsMessage(list, ClassName, 9));
  EXPECT_EQ(update.deletions(0).type(), foxglove::SceneEntityDeletion::ALL);
  ASSERT_EQ(update.entities_size(), 2);
  const foxglove::SceneEntity& entity = update.entities(0);
  EXPECT_EQ(entity.id(), "object 7");
  EXPECT_EQ(entity.texts(0).text(), "chair 7 (0.80)");
  EXPECT_EQ(entity.cubes(0).size().y(), 0.6);
  EXPECT_EQ(entity.cubes(0).pose().position().z(), 3);
  EXPECT_NEAR(entity.texts(0).pose().position().z(), 3.45, 1e-12);
  std::map<std::string, std::string> metadata;
  for (const auto& pair : entity.metadata()) metadata[pair.key()] = pair.value();
  EXPECT_EQ(metadata["class"], "chair");
  EXPECT_EQ(metadata["segments"], "4 9");
  EXPECT_EQ(update.entities(1).id(), "discovered 12");
}

TEST(SceneMessages, CellsAreCentresOfTheirState) {
  OccupancyMap map(0.1);
  OccupancyPlanes planes;
  planes.occupied[1] = 1;  // the layer z = 1, x = y = 0
  map.Set({-1, 0, 0}, BlockOccupancy(planes));
  map.Set({1, 0, 0}, BlockOccupancy(CellState::kFree));
  const auto occupied = Parsed<foxglove::PointCloud>(CellsMessage(map, CellState::kOccupied, 5));
  ASSERT_EQ(occupied.data().size(), occupied.point_stride());
  EXPECT_FLOAT_EQ(FieldAt<float>(occupied, "x", 0, 0), -0.75F);
  EXPECT_FLOAT_EQ(FieldAt<float>(occupied, "y", 0, 0), 0.05F);
  EXPECT_FLOAT_EQ(FieldAt<float>(occupied, "z", 0, 0), 0.15F);
  EXPECT_FLOAT_EQ(FieldAt<float>(occupied, "size", 0, 0), 0.1F);
  const auto free = Parsed<foxglove::PointCloud>(CellsMessage(map, CellState::kFree, 5));
  EXPECT_EQ(free.data().size(), 512 * free.point_stride());
  EXPECT_NE(FieldAt<uint8_t>(free, "red", 0, 0), FieldAt<uint8_t>(occupied, "red", 0, 0));
}

TEST(SceneMessages, AGridLiesAtTheHeightOfTheFloor) {
  GridMessage message;
  message.grid.resolution_m = 0.05;
  message.grid.origin_W = {-1.5, 0.25};
  message.grid.width = 3;
  message.grid.height = 1;
  message.grid.states = {CellState::kFree, CellState::kOccupied, CellState::kUnknown};
  message.grid.distances_m = {0.025F, 0, 0};
  message.grid.floor_m = {-0.3F, -0.2F, std::numeric_limits<float>::quiet_NaN()};
  const auto grid = Parsed<foxglove::Grid>(GroundGridMessage(message));
  EXPECT_EQ(grid.pose().position().x(), -1.5);
  EXPECT_FLOAT_EQ(static_cast<float>(grid.pose().position().z()), -0.2F);
  EXPECT_EQ(grid.column_count(), 3u);
  EXPECT_EQ(grid.data().size(), grid.row_stride());
  EXPECT_EQ(FieldAt<uint32_t>(grid, "state", 1, grid.cell_stride()), 2u);
  EXPECT_FLOAT_EQ(FieldAt<float>(grid, "distance_m", 0, grid.cell_stride()), 0.025F);
}

}  // namespace
}  // namespace vismap
