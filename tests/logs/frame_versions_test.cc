// Logs of every version of rgbd_frame_t are read. frames_v1.lcmlog and frames_v2.lcmlog hold the
// frames of kSequence as "vismap-log from-dataset" of each version wrote them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <vismap/rgbd_frame_v1_t.hpp>
#include <vismap/segmented_frame_v1_t.hpp>

#include "logs/log_reader.h"
#include "logs/recording.h"
#include "simulation/sequence.h"
#include "support/messages.h"
#include "wire/envelope.h"
#include "wire/older_frame.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr const char* kSequence = "synthetic:room?frames=2&width=64";
constexpr uint64_t kFirstVersion = 0xea608f82b8547b9e;

std::string PathOf(const std::string& log) {
  return std::string(VISMAP_SOURCE_DIR) + "/tests/logs/" + log;
}

void ExpectSameFrames(const Dataset& read, const Dataset& expected) {
  ASSERT_EQ(read.size(), expected.size());
  for (size_t i = 0; i < read.size(); ++i) {
    const Result<SensorFrame> a = read.Read(i), b = expected.Read(i);
    ASSERT_TRUE(a) << a.error().message;
    EXPECT_EQ(a->header.utime, b->header.utime);
    EXPECT_EQ(a->header.camera, b->header.camera);
    EXPECT_EQ(a->header.T_W_C.matrix(), b->header.T_W_C.matrix());
    EXPECT_EQ(read.Header(i).camera, b->header.camera);
    EXPECT_FALSE(a->optics);
    EXPECT_EQ(a->depth, b->depth);
    EXPECT_EQ(a->depth_unit_m, b->depth_unit_m);
    EXPECT_EQ(a->color, b->color);
    EXPECT_EQ(a->color_encoding, ColorEncoding::kJpeg);
  }
}

TEST(FrameVersions, LogsOfBothHaveTheSameFrames) {
  const auto expected = OpenSequence(kSequence, "", {});
  ASSERT_TRUE(expected) << expected.error().message;
  for (const std::string log : {"frames_v1.lcmlog", "frames_v2.lcmlog"}) {
    SCOPED_TRACE(log);
    const Result<Recording> recording = OpenRecording(PathOf(log), "", {});
    ASSERT_TRUE(recording) << recording.error().message;
    ExpectSameFrames(*recording->dataset, **expected);
  }
}

TEST(FrameVersions, TheFirstOneHasItsFingerprint) {
  EXPECT_EQ(rgbd_frame_v1_t::getHash(), static_cast<int64_t>(kFirstVersion));
}

rgbd_frame_v1_t FirstVersion() {
  const rgbd_frame_t current = Encode(SmallSensorFrame());
  rgbd_frame_v1_t older{};
  older.utime = current.utime;
  older.source = "camera";
  older.camera_id = current.camera_id;
  older.frame_number = current.frame_number;
  older.after_utime = 77;
  older.width = current.color_camera.width;
  older.height = current.color_camera.height;
  older.fx = older.fy = current.color_camera.fx;
  older.cx = current.color_camera.cx;
  older.cy = current.color_camera.cy;
  std::copy(std::begin(current.T_W_C), std::end(current.T_W_C), std::begin(older.T_W_C));
  older.depth_unit_m = current.depth_unit_m;
  older.depth_encoding = current.depth_encoding;
  older.depth_size = current.depth_size;
  older.depth = current.depth;
  older.color_encoding = current.color_encoding;
  older.color_size = current.color_size;
  older.color = current.color;
  return older;
}

TEST(FrameVersions, AnOlderMessageIsTheSameFrame) {
  rgbd_frame_v1_t older = FirstVersion();
  std::vector<uint8_t> bytes = Pack(older);
  const auto frame = Unpack<rgbd_frame_t>(bytes, bytes.size());
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->after_utime, 77);
  const Result<SensorFrame> sensor = Decode(*frame);
  ASSERT_TRUE(sensor) << sensor.error().message;
  EXPECT_EQ(sensor->depth, SmallSensorFrame().depth);
  const std::span<const uint8_t> all(bytes);
  const auto peeked = PeekFrameHeader(all.first(kFramePeekBytes), all.size());
  ASSERT_TRUE(peeked) << peeked.error().message;
  EXPECT_EQ(peeked->camera, kSmallCamera);
  bytes[bytes.size() - 50] ^= 1;
  EXPECT_THAT(Unpack<rgbd_frame_t>(bytes, bytes.size()).error().message, HasSubstr("checksum"));
  EXPECT_THAT(Unpack<rgbd_frame_t>(bytes, bytes.size() - 1).error().message, HasSubstr("allowed"));
}

TEST(FrameVersions, AnOlderSegmentedFrameHasTheSameFrame) {
  segmented_frame_v1_t older{};
  older.frame = FirstVersion();
  older.utime = older.frame.utime;
  older.source = "segmenter";
  older.had_detections = 1;
  older.label_encoding = segmented_frame_t::LABELS_RLE_ZSTD;
  older.labels = {1, 2, 3};
  older.label_size = 3;
  const auto message = Unpack<segmented_frame_t>(Pack(older), size_t{1} << 20);
  ASSERT_TRUE(message) << message.error().message;
  EXPECT_EQ(message->frame.depth, older.frame.depth);
  EXPECT_EQ(CameraOf(message->frame).width, kSmallCamera.width);
  EXPECT_EQ(message->had_detections, 1);
  EXPECT_EQ(message->labels, older.labels);
}

}  // namespace
}  // namespace vismap
