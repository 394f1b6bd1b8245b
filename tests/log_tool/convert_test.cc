#include "log_tool/convert.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/frame_codec.h"
#include "logs/recording.h"
#include "rectify/rectified_camera.h"
#include "support/log_builder.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Sequence {
  std::unique_ptr<Dataset> dataset;
  std::unique_ptr<DetectionSource> detections;
};

Sequence Open(const std::string& path) {
  auto recording = OpenRecording(path, "");
  EXPECT_TRUE(recording) << recording.error().message;
  Sequence sequence{std::move(recording->dataset), nullptr};
  if (const auto inside = sequence.dataset->default_detections_path())
    sequence.detections = std::move(*OpenRecordedDetections(*inside));
  return sequence;
}

ConvertResult ToFolder(const Sequence& sequence, const std::filesystem::path& folder,
                       std::optional<CameraId> camera = {}) {
  const auto result = WriteFolder(*sequence.dataset, sequence.detections.get(), camera, folder);
  EXPECT_TRUE(result) << result.error().message;
  return result.value_or(ConvertResult{});
}

/// SmallSensorFrame with a frame number.
LogBuilder& AddFrame(LogBuilder& builder, int64_t utime, int64_t number,
                     double depth_unit_m = 0.001) {
  SensorFrame frame = SmallSensorFrame(utime);
  frame.header.frame_number = number;
  frame.depth_unit_m = depth_unit_m;
  frame.depth(20, 20) = static_cast<uint16_t>(2000 + number);
  return builder.Add(kRgbdFrameChannel, Encode(frame), "sensor");
}

void ExpectSameFrames(const Sequence& a, const Sequence& b) {
  ASSERT_EQ(a.dataset->size(), b.dataset->size());
  for (size_t i = 0; i < a.dataset->size(); ++i) {
    const Result<SensorFrame> x = a.dataset->Read(i), y = b.dataset->Read(i);
    ASSERT_TRUE(x && y);
    EXPECT_EQ(x->header.utime, y->header.utime);
    EXPECT_EQ(x->header.frame_number, y->header.frame_number);
    EXPECT_EQ(x->header.camera, y->header.camera);
    EXPECT_EQ(x->header.T_W_C.matrix(), y->header.T_W_C.matrix());
    EXPECT_EQ(x->depth, y->depth);
    EXPECT_EQ(x->depth_unit_m, y->depth_unit_m);
    EXPECT_EQ(x->color, y->color);
    const Result<DetectionSet> of_x = a.detections->ForFrame(x->header);
    const Result<DetectionSet> of_y = b.detections->ForFrame(y->header);
    ASSERT_TRUE(of_x && of_y);
    ASSERT_EQ(of_x->detections.size(), of_y->detections.size());
    for (size_t k = 0; k < of_x->detections.size(); ++k) {
      EXPECT_EQ(of_x->detections[k].class_id, of_y->detections[k].class_id);
      EXPECT_EQ(of_x->detections[k].score, of_y->detections[k].score);
      EXPECT_EQ(of_x->detections[k].mask, of_y->detections[k].mask);
    }
  }
}

TEST(Convert, LogToFolderToLogKeepsEverything) {
  LogBuilder builder;
  for (int64_t i = 1; i <= 3; ++i)
    AddFrame(builder, 1000 * i * i, 2 * i, 0.0002).Detections(1000 * i * i);
  const Sequence log = Open(builder.Finish());
  const TempFolder out;
  const ConvertResult written = ToFolder(log, out / "folder");
  EXPECT_EQ(written.frames, 3);
  EXPECT_THAT(written.lost, IsEmpty());
  const Sequence folder = Open((out / "folder").string());
  EXPECT_EQ(folder.dataset->format(), "scenenn");
  // a folder does not store the camera id
  const auto back = WriteLog(*folder.dataset, folder.detections.get(), out / "back.lcmlog");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->frames, 3);
  ExpectSameFrames(log, folder);
  ExpectSameFrames(folder, Open((out / "back.lcmlog").string()));
}

TEST(Convert, FramesThatCannotBeReadAreLeftOut) {
  LogBuilder builder;
  rgbd_frame_t message = Encode(SmallSensorFrame(1000));
  std::vector<uint8_t> damaged = Pack(message);
  damaged[damaged.size() - 50] ^= 1;
  builder.AddBytes("RGBD_FRAME", damaged).Frame(2000).Frame(3000);
  const Sequence log = Open(builder.Finish());
  const TempFolder out;
  const auto folder = WriteFolder(*log.dataset, nullptr, {}, out / "folder");
  ASSERT_TRUE(folder) << folder.error().message;
  EXPECT_EQ(folder->frames, 2);
  EXPECT_THAT(folder->lost, ::testing::Contains(HasSubstr("1 of 3 frames were left out")));
  const auto copy = WriteLog(*log.dataset, nullptr, out / "copy.lcmlog");
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_EQ(copy->frames, 2);
  EXPECT_THAT(copy->lost, ElementsAre(HasSubstr("1 of 3 frames were left out")));
}

TEST(Convert, ReportsWhatAFolderCannotStore) {
  LogBuilder builder;
  DetectionSet unknown = SmallDetections(2000);
  unknown.detections[0].class_id = ClassId::kUnknown;
  AddFrame(builder, 2000, 0).Add(kDetectionsChannel, Encode(unknown, 64, 48));
  AddFrame(builder, 1000, 5);
  builder.Frame(3000, 8);
  const Sequence log = Open(builder.Finish());
  const TempFolder out;
  EXPECT_THAT(WriteFolder(*log.dataset, nullptr, {}, out / "folder").error().message,
              HasSubstr("cameras 3, 8"));
  EXPECT_THAT(
      ToFolder(log, out / "folder", CameraId{3}).lost,
      ElementsAre(HasSubstr("1 frame of other cameras"), HasSubstr("order of the frames"),
                  HasSubstr("numbers of the frames"), HasSubstr("no detector ran on 1 frame"),
                  HasSubstr("1 detection without a class")));
  const Sequence folder = Open((out / "folder").string());
  ASSERT_EQ(folder.dataset->size(), 2u);
  EXPECT_EQ(folder.dataset->Header(0).utime, 1000);
  EXPECT_EQ(folder.dataset->Header(0).frame_number, 1);
  EXPECT_EQ(folder.detections->ForFrame(folder.dataset->Header(1))->detections.size(), 1u);
}

TEST(Convert, WithoutADetectorTheFolderHasNoDetections) {
  LogBuilder builder;
  const Sequence log = Open(builder.Frame(1000).Finish());
  const TempFolder out;
  EXPECT_THAT(ToFolder(log, out / "folder").lost, IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(out / "folder/detections.json"));
}

TEST(Convert, AFolderHasRectifiedFrames) {
  const TempFolder out;
  LogBuilder raw;  // float depth and raw colour, seen through a lens
  SensorFrame lens = SmallSensorFrame();
  FrameOptics optics;
  optics.color = {kSmallCamera, Distortion::kBrownConrady, {-0.1, 0.02, 0, 0}};
  ASSERT_TRUE(SetOptics(optics, true, &lens));
  lens.color.assign(lens.depth.size(), 100);
  lens.color_encoding = ColorEncoding::kGrey;
  lens.depth_m = DepthInMetres(lens);
  lens.depth = {};
  const Sequence distorted = Open(raw.Add(kRgbdFrameChannel, Encode(lens)).Finish());
  const ConvertResult lost = ToFolder(distorted, out / "c");
  EXPECT_EQ(lost.frames, 1);
  EXPECT_THAT(lost.lost, ::testing::IsSupersetOf({HasSubstr("the images as they were taken"),
                                                  HasSubstr("parts of a millimetre")}));
}

TEST(Convert, RejectsFramesThatFormNoSequence) {
  LogBuilder changes;
  AddFrame(changes, 1000, 1, 0.001);
  AddFrame(changes, 2000, 2, 0.002);
  const TempFolder out;
  const Sequence changing = Open(changes.Finish());
  EXPECT_THAT(WriteFolder(*changing.dataset, nullptr, {}, out / "a").error().message,
              HasSubstr("utime 2000 has other intrinsics or another depth unit"));
  LogBuilder blind;
  SensorFrame frame = SmallSensorFrame();
  frame.color.clear();
  const Sequence colourless = Open(blind.Add(kRgbdFrameChannel, Encode(frame)).Finish());
  EXPECT_THAT(WriteFolder(*colourless.dataset, nullptr, {}, out / "b").error().message,
              HasSubstr("no colour"));
  EXPECT_THAT(WriteLog(*changing.dataset, nullptr, out / "missing/log").error().message,
              HasSubstr("missing/log"));
}

}  // namespace
}  // namespace vismap
