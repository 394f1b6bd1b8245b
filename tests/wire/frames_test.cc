#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vismap/frame_commit_t.hpp>

#include "codecs/frame_codec.h"
#include "codecs/raw_image.h"
#include "rectify/rectified_camera.h"
#include "support/messages.h"
#include "support/mutations.h"
#include "wire/detections.h"
#include "wire/envelope.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr size_t kCap = size_t{1} << 20;

std::vector<uint8_t> ZlibOf(const std::vector<uint8_t>& bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<uint8_t> code(size);
  EXPECT_EQ(compress(code.data(), &size, bytes.data(), bytes.size()), Z_OK);
  code.resize(size);
  return code;
}

void ExpectSameHeader(const FrameHeader& a, const FrameHeader& b) {
  EXPECT_EQ(a.utime, b.utime);
  EXPECT_EQ(a.camera_id, b.camera_id);
  EXPECT_EQ(a.frame_number, b.frame_number);
  EXPECT_EQ(a.camera, b.camera);
  EXPECT_EQ(a.T_W_C.matrix(), b.T_W_C.matrix());
}

SegmentedFrame SmallSegmentedFrame() {
  SegmentedFrame segmented;
  segmented.frame = *DecodeFrame(SmallSensorFrame());
  segmented.image.index =
      Image<SegmentIndex>(kSmallCamera.width, kSmallCamera.height, SegmentIndex::kNone);
  segmented.image.segment_count = 2;
  segmented.segments.resize(2);
  for (int v = 8; v < 40; ++v) {
    for (int u = 8; u < 60; ++u) {
      const int segment = u < 30 ? 0 : 1;
      segmented.image.index(v, u) = SegmentIndex{segment};
      ++segmented.segments[static_cast<size_t>(segment)].pixels;
    }
  }
  segmented.segments[1].detection = DetectionIndex{0};
  segmented.segments[1].class_id = ClassId{62};
  segmented.segments[1].score = 0.5F;
  segmented.segments[1].overlap = 0.9F;
  segmented.had_detections = true;
  return segmented;
}

template <typename Message>
Result<Message> Through(Message message) {
  message.seq = 5;
  message.source = "tester";
  return Unpack<Message>(Pack(message), kCap);
}

TEST(RgbdFrameMessage, DecodeInvertsEncode) {
  const SensorFrame frame = SmallSensorFrame();
  const auto message = Through(Encode(frame));
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(message->seq, 5);
  EXPECT_EQ(message->source, "tester");
  const Result<SensorFrame> back = Decode(*message);
  ASSERT_TRUE(back) << back.error().message;
  ExpectSameHeader(back->header, frame.header);
  EXPECT_EQ(back->depth, frame.depth);
  EXPECT_EQ(back->color, frame.color);
  EXPECT_EQ(back->depth_unit_m, frame.depth_unit_m);
}

TEST(RgbdFrameMessage, FrameWithoutColorIsEncoded) {
  SensorFrame frame = SmallSensorFrame();
  frame.color.clear();
  const auto back = Decode(*Through(Encode(frame)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->color.empty());
}

/// A change that makes a message invalid, and a word of the error message.
struct BadField {
  const char* word;
  void (*spoil)(rgbd_frame_t*);
};

TEST(RgbdFrameMessage, RejectsImpossibleCameraValues) {
  const BadField cases[] = {
      {"utime", [](rgbd_frame_t* m) { m->utime = -1; }},
      {"camera_id", [](rgbd_frame_t* m) { m->camera_id = -1; }},
      {"frame_number", [](rgbd_frame_t* m) { m->frame_number = -2; }},
      {"fx",
       [](rgbd_frame_t* m) { m->color_camera.fx = std::numeric_limits<double>::quiet_NaN(); }},
      {"T_W_C", [](rgbd_frame_t* m) { m->T_W_C[3] = std::numeric_limits<double>::infinity(); }},
      {"T_W_C", [](rgbd_frame_t* m) { m->T_W_C[0] = 2; }},
      {"depth_unit_m", [](rgbd_frame_t* m) { m->depth_unit_m = 0; }},
      {"depth_unit_m",
       [](rgbd_frame_t* m) { m->depth_unit_m = std::numeric_limits<double>::quiet_NaN(); }},
      {"depth_encoding", [](rgbd_frame_t* m) { m->depth_encoding = 99; }},
      {"color_encoding", [](rgbd_frame_t* m) { m->color_encoding = 99; }},
      {"color", [](rgbd_frame_t* m) { m->color_encoding = rgbd_frame_t::COLOR_NONE; }},
      {"color is empty", [](rgbd_frame_t* m) { m->color.clear(); }},
      {"color: raw colour: expected 64x48 pixels of 3 bytes, 9216 bytes in all, found",
       [](rgbd_frame_t* m) { m->color_encoding = rgbd_frame_t::COLOR_RAW_RGB; }},
      {"depth: raw depth: expected 64x48 pixels of 2 bytes, 6144 bytes in all, found",
       [](rgbd_frame_t* m) { m->depth_encoding = rgbd_frame_t::DEPTH_RAW_16; }},
      {"depth: float depth: expected 64x48",
       [](rgbd_frame_t* m) { m->depth_encoding = rgbd_frame_t::DEPTH_FLOAT_M; }},
      {"depth: zlib depth",
       [](rgbd_frame_t* m) { m->depth_encoding = rgbd_frame_t::DEPTH_ZLIB_16; }},
      {"depth: PNG: expected a 16-bit",
       [](rgbd_frame_t* m) { m->depth_encoding = rgbd_frame_t::DEPTH_PNG; }},
      {"color_camera: distortion 9 is unknown",
       [](rgbd_frame_t* m) { m->color_camera.distortion = 9; }},
      {"color_camera: Brown-Conrady distortion has 3 coefficients; expected 4, 5 or 8",
       [](rgbd_frame_t* m) {
         m->color_camera.distortion = camera_t::DISTORTION_BROWN_CONRADY;
         m->color_camera.coefficients = {0.1, 0, 0};
       }},
      {"depth_camera: equidistant distortion has 5",
       [](rgbd_frame_t* m) {
         m->depth_registered = 0;
         m->depth_camera.distortion = camera_t::DISTORTION_EQUIDISTANT;
         m->depth_camera.coefficients.assign(5, 0.1);
       }},
      {"color_camera: a coefficient is nan",
       [](rgbd_frame_t* m) {
         m->color_camera.distortion = camera_t::DISTORTION_BROWN_CONRADY;
         m->color_camera.coefficients.assign(4, std::numeric_limits<double>::quiet_NaN());
       }},
      {"T_color_depth", [](rgbd_frame_t* m) { m->depth_registered = 0, m->T_color_depth[0] = 2; }},
      {"T_color_depth: the cameras are 15",
       [](rgbd_frame_t* m) { m->depth_registered = 0, m->T_color_depth[3] = 15; }},
      {"depth", [](rgbd_frame_t* m) { m->depth.resize(m->depth.size() / 2); }},
      {"camera size",
       [](rgbd_frame_t* m) { m->color_camera.height = 4096, m->color_camera.width = 16384; }},
  };
  for (const BadField& bad : cases) {
    rgbd_frame_t message = Encode(SmallSensorFrame());
    bad.spoil(&message);
    const auto back = Decode(message);
    ASSERT_FALSE(back) << bad.word;
    EXPECT_THAT(back.error().message, HasSubstr(bad.word));
  }
}

TEST(RgbdFrameMessage, RejectsColorOfAnotherSize) {
  SensorFrame frame = SmallSensorFrame();
  frame.color = EncodeJpeg(Image<Rgb8>(32, 48));
  const auto back = Decode(Encode(frame));
  ASSERT_FALSE(back);
  EXPECT_THAT(back.error().message, HasSubstr("32x48"));
}

/// A frame with depth beside colour, both with distortion.
SensorFrame UnregisteredFrame() {
  SensorFrame frame = SmallSensorFrame();
  FrameOptics optics;
  optics.color = {{64, 48, 52, 52, 31.5, 23.5}, Distortion::kBrownConrady, {0.1, -0.05, 0, 0, 0}};
  optics.depth = {{40, 30, 26, 26, 19.5, 14.5}, Distortion::kEquidistant, {0.01, 0, 0, 0}};
  optics.depth_registered = false;
  optics.T_color_depth.translation().x() = 0.02;
  frame.depth = Image<uint16_t>(40, 30, 1500);
  EXPECT_TRUE(SetOptics(optics, true, &frame));
  return frame;
}

TEST(RgbdFrameMessage, CamerasOfAnUnregisteredFrameAreKept) {
  const SensorFrame frame = UnregisteredFrame();
  const auto back = Decode(*Through(Encode(frame)));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_TRUE(back->optics);
  EXPECT_EQ(back->optics->color, frame.optics->color);
  EXPECT_EQ(back->optics->depth, frame.optics->depth);
  EXPECT_FALSE(back->optics->depth_registered);
  EXPECT_EQ(back->optics->T_color_depth.matrix(), frame.optics->T_color_depth.matrix());
  EXPECT_EQ(back->depth, frame.depth);
  EXPECT_EQ(back->header.camera, (PinholeCamera{32, 24, 26, 26, 15.5, 11.5}))
      << "the view of the colour camera with the resolution of depth";
  EXPECT_EQ(DecodeFrame(*back).error().message,
            "frame utime 1000 of camera 3: the frame has not been rectified");
}

TEST(RgbdFrameMessage, EveryEncodingOfTheSameImagesDecodesToTheSame) {
  rgbd_frame_t message = Encode(SmallSensorFrame());
  const SensorFrame expected = *Decode(message);
  const Image<uint16_t>& depth = expected.depth;
  const auto set_depth = [&](int8_t encoding, std::vector<uint8_t> bytes) {
    message.depth_encoding = encoding;
    message.depth = std::move(bytes);
    message.depth_size = static_cast<int32_t>(message.depth.size());
  };
  const auto* raw = reinterpret_cast<const uint8_t*>(depth.data());
  const std::vector<uint8_t> raw16(raw, raw + 2 * depth.size());
  set_depth(rgbd_frame_t::DEPTH_RAW_16, raw16);
  EXPECT_EQ(Decode(message)->depth, depth);
  set_depth(rgbd_frame_t::DEPTH_ZLIB_16, ZlibOf(raw16));
  EXPECT_EQ(Decode(message)->depth, depth);
  std::vector<uint8_t> png;
  const cv::Mat mat(depth.height(), depth.width(), CV_16UC1, const_cast<uint16_t*>(depth.data()));
  ASSERT_TRUE(cv::imencode(".png", mat, png));
  set_depth(rgbd_frame_t::DEPTH_PNG, png);
  EXPECT_EQ(Decode(message)->depth, depth);
  set_depth(rgbd_frame_t::DEPTH_FLOAT_M, EncodeRawFloat(DepthInMetres(expected)));
  const SensorFrame floats = *Decode(message);
  EXPECT_TRUE(floats.depth.empty());
  const Image<float> metres = DepthInMetres(floats), same = DepthInMetres(expected);
  EXPECT_EQ(std::memcmp(metres.data(), same.data(), metres.size() * sizeof(float)), 0);
  EXPECT_EQ(Encode(floats).depth, message.depth) << "metres are not rounded";
}

TEST(RgbdFrameMessage, PeekFrameHeaderKnowsTheCameraOfEveryKindOfFrame) {
  SensorFrame without_color = SmallSensorFrame();
  without_color.color.clear();
  rgbd_frame_t of_depth = Encode(without_color);
  of_depth.color_camera = camera_t{};  // is ignored
  for (rgbd_frame_t message : {Encode(UnregisteredFrame()), of_depth}) {
    const std::vector<uint8_t> bytes = Pack(message);
    const std::span<const uint8_t> all(bytes);
    const auto header =
        PeekFrameHeader(all.first(std::min(all.size(), kFramePeekBytes)), all.size());
    ASSERT_TRUE(header) << header.error().message;
    ExpectSameHeader(*header, *DecodeHeader(message));
  }
}

TEST(RgbdFrameMessage, PeekFrameHeaderNeedsOnlyTheFirstBytes) {
  rgbd_frame_t message = Encode(SmallSensorFrame());
  message.source = "some-camera";
  const std::vector<uint8_t> bytes = Pack(message);
  const std::span<const uint8_t> all(bytes);
  ASSERT_GT(bytes.size(), kFramePeekBytes);
  const Result<FrameHeader> header = PeekFrameHeader(all.first(kFramePeekBytes), all.size());
  ASSERT_TRUE(header) << header.error().message;
  ExpectSameHeader(*header, SmallSensorFrame().header);
  size_t enough = 0;
  while (!PeekFrameHeader(all.first(enough), all.size())) ++enough;
  EXPECT_GT(enough, 200u);
  EXPECT_THAT(PeekFrameHeader(all.first(enough - 1), all.size()).error().message,
              HasSubstr("truncated"));
  message.camera_id = -1;
  const auto error_of = [](auto* other) {
    const std::vector<uint8_t> packed = Pack(*other);
    return PeekFrameHeader(packed, packed.size()).error().message;
  };
  EXPECT_THAT(error_of(&message), HasSubstr("camera_id"));
  frame_commit_t other{};
  EXPECT_THAT(error_of(&other), HasSubstr("fingerprint"));
}

TEST(DetectionsMessage, DecodeInvertsEncode) {
  const DetectionSet set = SmallDetections();
  const auto back = Decode(*Through(Encode(set, kSmallCamera.width, kSmallCamera.height)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->utime, set.utime);
  EXPECT_EQ(back->camera_id, set.camera_id);
  EXPECT_EQ(back->frame_number, set.frame_number);
  ASSERT_EQ(back->detections.size(), set.detections.size());
  for (size_t i = 0; i < set.detections.size(); ++i) {
    EXPECT_EQ(back->detections[i].class_id, set.detections[i].class_id);
    EXPECT_EQ(back->detections[i].score, set.detections[i].score);
    EXPECT_EQ(back->detections[i].mask, set.detections[i].mask);
  }
}

TEST(DetectionsMessage, MessageWithoutDetectionsIsValid) {
  const DetectionSet none{1000, CameraId{0}, 1, {}};
  const auto back = Decode(*Through(Encode(none, 640, 480)));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(back->detections.empty());
}

TEST(DetectionsMessage, MessageSaysThatNoDetectorRan) {
  const FrameHeader header = SmallSensorFrame().header;
  const Result<detections_t> message = Through(EncodeDetectorDidNotRun(header));
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_FALSE(DetectorRan(*message));
  EXPECT_EQ(message->utime, header.utime);
  EXPECT_EQ(message->camera_id, Raw(header.camera_id));
  EXPECT_TRUE(DetectorRan(Encode(DetectionSet{}, 64, 48)));
}

TEST(DetectionsMessage, RejectsImpossibleValues) {
  const auto refused = [](auto spoil) {
    detections_t message = Encode(SmallDetections(), kSmallCamera.width, kSmallCamera.height);
    spoil(&message);
    return !Decode(message).has_value();
  };
  EXPECT_TRUE(refused([](detections_t* m) { m->detections[0].score = 1.5F; }));
  EXPECT_TRUE(refused(
      [](detections_t* m) { m->detections[0].score = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(refused([](detections_t* m) { m->detections[0].class_id = 65536; }));
  EXPECT_TRUE(refused([](detections_t* m) { m->detections[0].class_id = -1; }));
  EXPECT_TRUE(refused([](detections_t* m) { m->detections[1].runs[0] = -5; }));
  EXPECT_TRUE(refused([](detections_t* m) { m->detections[1].runs.back() += 1; }));
  EXPECT_TRUE(refused([](detections_t* m) { m->image_width = 0; }));
  EXPECT_TRUE(refused([](detections_t* m) { m->image_height = 20000; }));
}

TEST(DetectionsMessage, MaskSizeIsLimited) {
  detections_t message{};
  message.image_width = message.image_height = 4096;
  detection_t whole{};
  whole.runs = {0, 4096 * 4096};  // 8 bytes encode 16 million pixels
  whole.n_runs = 2;
  message.detections.assign(100, whole);
  message.n_detections = 100;
  const auto back = Decode(message);
  ASSERT_FALSE(back);
  EXPECT_THAT(back.error().message, HasSubstr("too many pixels"));
}

TEST(SegmentedFrameMessage, DecodeInvertsEncode) {
  const SegmentedFrame segmented = SmallSegmentedFrame();
  const auto message = Through(Encode(segmented, Encode(SmallSensorFrame())));
  ASSERT_TRUE(message) << message.error().message;
  const auto back = Decode(*message);
  ASSERT_TRUE(back) << back.error().message;
  ExpectSameHeader(back->frame.header, segmented.frame.header);
  EXPECT_EQ(back->frame.color, segmented.frame.color);
  EXPECT_EQ(std::memcmp(back->frame.depth.data(), segmented.frame.depth.data(),
                        4 * segmented.frame.depth.size()),
            0)
      << "depth, including its NaNs";
  EXPECT_EQ(back->image.index, segmented.image.index);
  EXPECT_EQ(back->image.segment_count, segmented.image.segment_count);
  EXPECT_EQ(back->segments, segmented.segments);
  EXPECT_TRUE(back->had_detections);
}

TEST(SegmentedFrameMessage, ContainsTheSensorMessageUnchanged) {
  rgbd_frame_t sensor = Encode(SmallSensorFrame());
  sensor.seq = 41;
  sensor.source = "camera";
  const std::vector<uint8_t> before = Pack(sensor);
  auto message = Through(Encode(SmallSegmentedFrame(), sensor));
  ASSERT_TRUE(message);
  EXPECT_EQ(Pack(message->frame), before);
}

TEST(SegmentedFrameMessage, RejectsValuesThatDisagreeWithTheLabelImage) {
  const auto error_of = [](auto spoil) {
    segmented_frame_t message = Encode(SmallSegmentedFrame(), Encode(SmallSensorFrame()));
    spoil(&message);
    const auto back = Decode(message);
    return back ? std::string("accepted") : back.error().message;
  };
  EXPECT_THAT(error_of([](segmented_frame_t* m) { ++m->segments[0].pixels; }), HasSubstr("pixels"));
  EXPECT_THAT(error_of([](segmented_frame_t* m) { m->segments.pop_back(), --m->n_segments; }),
              HasSubstr("listed"));
  EXPECT_THAT(error_of([](segmented_frame_t* m) { m->utime += 1; }), HasSubstr("utime"));
  EXPECT_THAT(error_of([](segmented_frame_t* m) { m->segments[1].overlap = 2; }),
              HasSubstr("overlap"));
  EXPECT_THAT(error_of([](segmented_frame_t* m) { m->segments[1].detection = -2; }),
              HasSubstr("detection"));
  EXPECT_THAT(error_of([](segmented_frame_t* m) { m->label_encoding = 9; }),
              HasSubstr("label_encoding"));
  EXPECT_THAT(error_of([](segmented_frame_t* m) { m->labels.clear(); }), ::testing::Ne("accepted"));
}

/// Decoding damaged bytes gives an error or a value, with the checksum and also without it, since
/// an attacker would set it to 0.
template <typename Message>
void SurvivesMutations(Message message) {
  message.source = "tester";
  std::vector<uint8_t> good = Pack(message);
  int accepted = 0;
  const auto decode = [&](const std::vector<uint8_t>& bytes) {
    const Result<Message> unpacked = Unpack<Message>(bytes, kCap);
    if (unpacked && Decode(*unpacked)) ++accepted;
  };
  ForEachMutation(good, 2000, decode);
  EXPECT_LT(accepted, 200)
      << "the checksum detects all damage after it, and only few bytes are before it";
  const size_t checksum = envelope::ChecksumOffset(message.source);
  envelope::WriteBigEndian(0, good.data() + checksum);
  ForEachMutation(good, 10000, decode);
}

TEST(RgbdFrameMessage, SurvivesMutations) { SurvivesMutations(Encode(SmallSensorFrame())); }
TEST(DetectionsMessage, SurvivesMutations) { SurvivesMutations(Encode(SmallDetections(), 64, 48)); }
TEST(SegmentedFrameMessage, SurvivesMutations) {
  SurvivesMutations(Encode(SmallSegmentedFrame(), Encode(SmallSensorFrame())));
}

}  // namespace
}  // namespace vismap
