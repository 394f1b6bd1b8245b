#include "foreign/foreign_messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "foreign/presets.h"
#include "support/foreign_builder.h"

namespace vismap {
namespace {

using namespace foreign_test;  // NOLINT
using ::testing::HasSubstr;

constexpr ImageRole kDepth = ImageRole::kDepth, kColor = ImageRole::kColor;

Result<ForeignMessage> DecodedRos(const std::string& encoding, const Bytes& data, int step,
                                  ImageRole role, bool big_endian = false) {
  foreign::sensor_msgs::Image image = RosImage(1000, encoding, data, step);
  image.width = 2;
  image.height = 2;
  image.is_bigendian = big_endian ? 1 : 0;
  return DecodeForeign(Pack(image), "images", {role, "world", "body", ""});
}

TEST(ForeignMessages, RoundStampsThatWereTruncated) {
  EXPECT_EQ(UtimeOf(1760000000, 33'332'999), 1'760'000'000'033'333);
  EXPECT_EQ(UtimeOf(0, 0), 0);
}

TEST(ForeignMessages, RemoveThePaddingOfRows) {
  const auto message = DecodedRos("16UC1", {1, 0, 2, 0, 9, 9, 3, 0, 4, 0, 9, 9}, 6, kDepth);
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(message->depth->bytes, Bytes({1, 0, 2, 0, 3, 0, 4, 0}));
}

TEST(ForeignMessages, MakeBigEndianDepthLittle) {
  const auto message = DecodedRos("16UC1", {0, 1, 0, 2, 0, 3, 0, 4}, 4, kDepth, true);
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(message->depth->bytes, Bytes({1, 0, 2, 0, 3, 0, 4, 0}));
}

TEST(ForeignMessages, KnowTheEncodingsOfDimos) {
  const std::pair<const char*, PixelFormat> colors[] = {
      {"rgb8", PixelFormat::kRgb},   {"bgr8", PixelFormat::kBgr},   {"rgba8", PixelFormat::kRgba},
      {"bgra8", PixelFormat::kBgra}, {"mono8", PixelFormat::kGrey}, {"mono16", PixelFormat::kGrey}};
  for (const auto& [name, format] : colors) {
    const auto message = DecodedRos(name, Bytes(16), 0, kColor);
    ASSERT_TRUE(message) << name << ": " << message.error().message;
    EXPECT_EQ(message->color->format, format) << name;
  }
  for (const char* name : {"16UC1", "mono16", "16SC1"}) {
    const auto message = DecodedRos(name, Bytes(8), 0, kDepth);
    ASSERT_TRUE(message) << name;
    EXPECT_EQ(message->depth->format, PixelFormat::kDepth16) << name;
  }
  const auto doubles = DecodedRos("64FC1", Bytes(32), 0, kDepth);
  ASSERT_TRUE(doubles);
  EXPECT_EQ(doubles->depth->format, PixelFormat::kDepthFloat);
  EXPECT_EQ(doubles->depth->bytes.size(), 16u);
}

TEST(ForeignMessages, RejectWhatIsNoImageOfItsRole) {
  EXPECT_FALSE(DecodedRos("rgb8", Bytes(12), 0, kDepth));
  EXPECT_FALSE(DecodedRos("32FC1", Bytes(16), 0, kColor));
  EXPECT_FALSE(DecodedRos("jpeg", Bytes(16), 0, kDepth));
  EXPECT_FALSE(DecodedRos("bayer_rggb8", Bytes(16), 0, kColor));
  EXPECT_FALSE(DecodedRos("rgb8", Bytes(11), 0, kColor)) << "too short";
  EXPECT_FALSE(DecodedRos("rgb8", Bytes(12), 5, kColor)) << "rows too short";
  EXPECT_FALSE(DecodedRos("rgb8", Bytes(12), -6, kColor));
}

TEST(ForeignMessages, RejectPosesThatAreNone) {
  Pose pose = Pose::Identity();
  foreign::geometry_msgs::TransformStamped stamped = Transform(0, "a", "b", pose);
  stamped.transform.rotation.w = 0.5;
  EXPECT_FALSE(DecodeForeign(Tf({stamped}), "tf", {}));
  stamped.transform.rotation.w = 1;
  stamped.transform.translation.x = std::nan("");
  EXPECT_FALSE(DecodeForeign(Tf({stamped}), "tf", {}));
}

TEST(ForeignMessages, OneBadPoseDoesNotCostTheOthers) {
  using Change = std::function<void(foreign::geometry_msgs::TransformStamped*)>;
  const std::vector<std::pair<Change, std::string>> changes = {
      {[](auto* bad) { bad->transform.rotation.w = 2; }, "unit length"},
      {[](auto* bad) { bad->transform.rotation.x = std::nan(""); }, "not finite"},
      {[](auto* bad) { bad->transform.translation.z = INFINITY; }, "not finite"},
      {[](auto* bad) { bad->header.stamp.sec = -5; }, "its time -4999995 us is impossible"},
      {[](auto* bad) { bad->child_frame_id = ""; }, "a frame has no name"},
      {[](auto* bad) { bad->header.frame_id = ""; }, "a frame has no name"},
      {[](auto* bad) { bad->header.frame_id = "bad"; }, "a frame is its own parent"},
      {[](auto* bad) { bad->child_frame_id = std::string(300, 'x'); }, "300 characters"}};
  for (const auto& [change, why] : changes) {
    foreign::geometry_msgs::TransformStamped bad = Transform(5, "world", "bad", BodyAt(0));
    change(&bad);
    const auto message = DecodeForeign(Tf({Transform(5, "world", "first", BodyAt(0)), bad,
                                           Transform(5, "world", "last", BodyAt(0))}),
                                       "tf", {});
    ASSERT_TRUE(message) << message.error().message;
    ASSERT_EQ(message->edges.size(), 2u) << why;
    EXPECT_EQ(message->edges[0].child, "first");
    EXPECT_EQ(message->edges[1].child, "last");
    ASSERT_EQ(message->left_out.size(), 1u) << why;
    EXPECT_NE(message->left_out[0].find("TFMessage, the pose of '"), std::string::npos);
    EXPECT_NE(message->left_out[0].find(why), std::string::npos) << message->left_out[0];
    const auto alone = DecodeForeign(Tf({bad}), "tf", {});
    ASSERT_FALSE(alone);
    EXPECT_NE(alone.error().message.find(why), std::string::npos) << alone.error().message;
  }
}

TEST(ForeignMessages, OneBadLinkOfDrakeDoesNotCostTheOthers) {
  foreign::drake::lcmt_viewer_draw draw{};
  draw.num_links = 3;
  draw.link_name = {"good", "", "turned"};
  draw.robot_num = {1, 1, 1};
  draw.position = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  draw.quaternion = {{1, 0, 0, 0}, {1, 0, 0, 0}, {9, 0, 0, 0}};
  const auto message = DecodeForeign(Pack(draw), "D", {kColor, "world", "b", "x"});
  ASSERT_TRUE(message) << message.error().message;
  ASSERT_EQ(message->edges.size(), 1u);
  EXPECT_EQ(message->edges[0].child, "good@1");
  EXPECT_EQ(message->left_out.size(), 2u);
}

TEST(ForeignMessages, DecodeOnlyTheImagesThatAreNeeded) {
  foreign::drake::lcmt_image_array array{};
  ASSERT_GT(array.decode(DrakeImages(5).data(), 0, 1 << 20), 0);
  const foreign::drake::lcmt_image depth = array.images[0], color = array.images[1];
  foreign::drake::lcmt_image bad_depth = depth, bad_color = color;
  bad_depth.compression_method = 77;
  bad_color.data.resize(9);
  bad_color.size = 9;
  const auto decoded = [&](std::vector<foreign::drake::lcmt_image> images, bool wants_color) {
    array.images = std::move(images);
    array.num_images = static_cast<int32_t>(array.images.size());
    return DecodeForeign(Pack(array), "images", {kColor, "world", "b", "x", wants_color});
  };
  const auto first = decoded({depth, color, bad_depth, bad_color}, true);
  ASSERT_TRUE(first && first->color && first->depth);
  EXPECT_TRUE(first->left_out.empty()) << "the others are not decoded";
  const auto second = decoded({bad_depth, bad_color, depth, color}, true);
  ASSERT_TRUE(second && second->color && second->depth);
  EXPECT_EQ(second->left_out.size(), 2u);
  const auto depth_alone = decoded({bad_color, depth}, false);
  ASSERT_TRUE(depth_alone && depth_alone->depth);
  EXPECT_FALSE(depth_alone->color);
  EXPECT_TRUE(depth_alone->left_out.empty());
  EXPECT_FALSE(decoded({bad_color, bad_depth}, true));

  foreign::bot_core::images_t images{};
  ASSERT_GT(images.decode(BotImages(5, 5).data(), 0, 1 << 20), 0);
  images.images[0].pixelformat = 1;
  const auto bot = DecodeForeign(Pack(images), "images", {kColor, "local", "b", "x"});
  ASSERT_TRUE(bot && bot->depth);
  EXPECT_FALSE(bot->color);
  EXPECT_EQ(bot->left_out.size(), 1u);
}

TEST(ForeignMessages, ReadDistortion) {
  ForeignCamera camera;
  ASSERT_TRUE(SetDistortion("plumb_bob", {0.1, 0, 0, 0, 0}, &camera));
  EXPECT_EQ(camera.distortion, ForeignCamera::Distortion::kBrownConrady);
  ASSERT_TRUE(SetDistortion("equidistant", {0.1, 0, 0, 0}, &camera));
  EXPECT_EQ(camera.distortion, ForeignCamera::Distortion::kEquidistant);
  ASSERT_TRUE(SetDistortion("plumb_bob", {0, 0, 0, 0, 0}, &camera));
  EXPECT_EQ(camera.distortion, ForeignCamera::Distortion::kNone);
  EXPECT_TRUE(camera.coefficients.empty());
  EXPECT_FALSE(SetDistortion("plumb_bob", {0.1, 0}, &camera));
  EXPECT_FALSE(SetDistortion("equidistant", {0.1, 0, 0, 0, 0}, &camera));
  EXPECT_FALSE(SetDistortion("thin_prism", {0.1, 0, 0, 0}, &camera));
}

TEST(ForeignMessages, TakeTheFramesOfATransformFromItsChannel) {
  const std::vector<std::array<std::string, 3>> cases = {{"CAMERA_TO_LOCAL", "CAMERA", "local"},
                                                         {"X_TO_HEAD", "x", "HEAD"},
                                                         {"HEAD_TO_BODY", "HEAD", "body"},
                                                         {"POSE", "x", "local"}};
  for (const auto& [channel, child, parent] : cases) {
    const auto message =
        DecodeForeign(BotTransform(5, BodyAt(0)), channel, {kColor, "local", "body", "x"});
    ASSERT_TRUE(message) << channel;
    EXPECT_EQ(message->edges.at(0).child, child) << channel;
    EXPECT_EQ(message->edges.at(0).parent, parent) << channel;
  }
}

TEST(ForeignMessages, PosesAtImpossibleTimesAreErrors) {
  constexpr int64_t kMost = std::numeric_limits<int64_t>::max();
  for (const int64_t utime : {-kMost - 1, int64_t{-1}, kLatestUtime + 1, kMost}) {
    EXPECT_FALSE(DecodeForeign(BotTransform(utime, BodyAt(0)), "C", {kColor, "local", "b", "x"}));
    EXPECT_FALSE(DecodeForeign(BotPose(utime, BodyAt(0)), "C", {kColor, "local", "b", "x"}));
  }
  foreign::drake::lcmt_viewer_draw draw{};
  for (const int64_t timestamp : {int64_t{-1}, kMost, kLatestUtime}) {
    draw.timestamp = timestamp;
    EXPECT_FALSE(DecodeForeign(Pack(draw), "DRAKE_VIEWER_DRAW", {kColor, "world", "b", "x"}));
  }
  EXPECT_TRUE(DecodeForeign(BotPose(kLatestUtime, BodyAt(0)), "C", {kColor, "local", "b", "x"}));
}

TEST(ForeignImage, DamagedZlibIsAnError) {
  Bytes packed = Zipped(Bytes(100, 7));
  EXPECT_EQ(*InflateZlib(packed, 100), Bytes(100, 7));
  EXPECT_FALSE(InflateZlib(packed, 99));
  EXPECT_FALSE(InflateZlib(packed, 101));
  packed.resize(packed.size() / 2);
  EXPECT_FALSE(InflateZlib(packed, 100));
}

TEST(ForeignImage, NegativeDepthIsNone) {
  Bytes values = {1, 0, 0xff, 0xff, 0, 0x80};
  ClearNegative(&values);
  EXPECT_EQ(values, Bytes({1, 0, 0, 0, 0, 0}));
}

// A PNG file with 2 x 1 pixels of colour.
Bytes PngOf(const Bytes& rgb) {
  Bytes file = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  const auto add_number = [&](uint32_t number) {
    for (int shift = 24; shift >= 0; shift -= 8)
      file.push_back(static_cast<uint8_t>(number >> shift));
  };
  const auto add_chunk = [&](const std::string& name, const Bytes& data) {
    add_number(static_cast<uint32_t>(data.size()));
    const size_t begin = file.size();
    file.insert(file.end(), name.begin(), name.end());
    file.insert(file.end(), data.begin(), data.end());
    add_number(static_cast<uint32_t>(
        crc32(0, file.data() + begin, static_cast<uInt>(file.size() - begin))));
  };
  Bytes row = {0};  // no filter
  row.insert(row.end(), rgb.begin(), rgb.end());
  add_chunk("IHDR", {0, 0, 0, 2, 0, 0, 0, 1, 8, 2, 0, 0, 0});
  add_chunk("IDAT", Zipped(row));
  add_chunk("IEND", {});
  return file;
}

TEST(ForeignImage, RedAndBlueOfAPngAreExchanged) {
  ForeignImage image{5, "optical", 2, 1};
  image.format = PixelFormat::kPng;
  image.bytes = PngOf({1, 2, 3, 250, 251, 252});
  const Result<ForeignImage> swapped = SwapRedBlue(image);
  ASSERT_TRUE(swapped) << swapped.error().message;
  EXPECT_EQ(swapped->format, PixelFormat::kBgr) << "what is read as red, first, is blue";
  EXPECT_EQ(swapped->bytes, Bytes({1, 2, 3, 250, 251, 252}));
  image.bytes.resize(30);
  EXPECT_FALSE(SwapRedBlue(image));
}

TEST(Presets, AreFoundByTheChannelsOfALog) {
  EXPECT_EQ(FindPreset({kDepthChannel, kTfChannel}), AdapterPreset::kDimos);
  EXPECT_EQ(FindPreset({"OPENNI_FRAME"}), AdapterPreset::kBotcore);
  EXPECT_EQ(FindPreset({"DRAKE_RGBD_CAMERA_IMAGES_wrist"}), AdapterPreset::kDrake);
  EXPECT_EQ(FindPreset({"RGBD_FRAME"}), AdapterPreset::kAuto);
}

TEST(Presets, SetOnlyWhatIsNotGiven) {
  AdapterOptions options;
  options.preset = AdapterPreset::kDimos;
  options.root = "map";
  const AdapterOptions complete = WithPreset(options);
  EXPECT_EQ(complete.root, "map");
  EXPECT_EQ(complete.depth_channel, kDepthChannel);
}

TEST(Presets, AStarStandsForAnyEnding) {
  EXPECT_TRUE(ChannelMatches("A_*", "A_b"));
  EXPECT_FALSE(ChannelMatches("A_*", "B_A_"));
  EXPECT_FALSE(ChannelMatches("A_", "A_b"));
  EXPECT_EQ(ChannelExpression("/a.b#c*"), "/a\\.b#c.*");
}

}  // namespace
}  // namespace vismap
