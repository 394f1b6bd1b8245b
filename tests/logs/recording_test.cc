#include "logs/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/file.h"
#include "logs/log_reader.h"
#include "support/log_builder.h"
#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Recording Open(const std::string& path, const DatasetOptions& options = {}) {
  Result<Recording> recording = OpenRecording(path, "", options);
  EXPECT_TRUE(recording) << recording.error().message;
  return recording ? std::move(*recording) : Recording{};
}

std::vector<int64_t> Utimes(const Dataset& dataset) {
  std::vector<int64_t> utimes;
  for (size_t i = 0; i < dataset.size(); ++i) utimes.push_back(dataset.Header(i).utime);
  return utimes;
}

std::vector<std::string> SkippedReasons(const Dataset& dataset) {
  std::vector<std::string> reasons;
  for (const SkippedFrame& skipped : dataset.skipped()) reasons.push_back(skipped.reason);
  return reasons;
}

TEST(OpenRecording, FramesAreReadInOrderOfArrival) {
  LogBuilder builder;
  const Recording recording = Open(builder.Frame(1000, 3).Frame(2000, 5).Finish());
  EXPECT_EQ(recording.dataset->format(), "lcmlog");
  EXPECT_EQ(recording.dataset->name(), "run.lcmlog");
  ASSERT_THAT(Utimes(*recording.dataset), ElementsAre(1000, 2000));
  EXPECT_THAT(recording.remarks, IsEmpty());
  EXPECT_EQ(recording.dataset->default_detections_path(), std::nullopt);
  const SensorFrame sent = SmallSensorFrame(2000, 5);
  const FrameHeader header = recording.dataset->Header(1);
  EXPECT_EQ(header.camera_id, CameraId{5});
  EXPECT_EQ(header.frame_number, sent.header.frame_number);
  EXPECT_EQ(header.camera, sent.header.camera);
  EXPECT_EQ(header.T_W_C.matrix(), sent.header.T_W_C.matrix());
  const Result<SensorFrame> read = recording.dataset->Read(1);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->header.camera_id, CameraId{5});
  EXPECT_EQ(read->depth, sent.depth);
  EXPECT_EQ(read->color, sent.color);
  EXPECT_EQ(read->depth_unit_m, sent.depth_unit_m);
}

TEST(OpenRecording, ChannelsMayHaveAPrefix) {
  LogBuilder builder;
  rgbd_frame_t frame = Encode(SmallSensorFrame(1000, 3));
  rgbd_frame_t other = Encode(SmallSensorFrame(2000, 3));
  detections_t found = Encode(SmallDetections(1000, 3), kSmallCamera.width, kSmallCamera.height);
  builder.AddBytes("vismap/RGBD_FRAME", Pack(frame)).AddBytes("other/RGBD_FRAME", Pack(other));
  const std::string path = builder.AddBytes("vismap/DETECTIONS", Pack(found)).Finish();
  const Result<Recording> recording = OpenRecording(path, "", {}, {}, "vismap/");
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_THAT(Utimes(*recording->dataset), ElementsAre(1000));
  const auto source = OpenRecordedDetections(path, "vismap/");
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_TRUE((*source)->DetectorRan(recording->dataset->Header(0)));
  const Result<Recording> without = OpenRecording(path, "");
  ASSERT_FALSE(without);
  EXPECT_THAT(without.error().message, HasSubstr("--channel-prefix 'other/'"));
}

TEST(OpenRecording, WithCommitsTheOrderIsThatOfTheMap) {
  LogBuilder builder;
  builder.Frame(1000).Frame(2000).Frame(2000).Frame(3000).Frame(4000).Detections(1000);
  builder.Detections(2000).Detections(3000).Commit(2000, 1).Commit(1000, 2).Skip(3000, "no depth");
  const std::string path = builder.Finish();
  const Recording committed = Open(path);
  EXPECT_THAT(Utimes(*committed.dataset), ElementsAre(2000, 1000));
  EXPECT_THAT(committed.remarks, IsEmpty());
  EXPECT_THAT(SkippedReasons(*committed.dataset),
              ElementsAre(HasSubstr("utime 3000 was not committed in the recorded run"),
                          HasSubstr("utime 4000 was not committed in the recorded run")));
  EXPECT_EQ(committed.dataset->default_detections_path(), path);

  const Recording all = Open(path + "?frames=all");
  EXPECT_THAT(Utimes(*all.dataset), ElementsAre(1000, 2000, 3000, 4000));
  EXPECT_THAT(all.dataset->skipped(), IsEmpty());
  DatasetOptions every_second;
  every_second.stride = 2;
  EXPECT_THAT(Utimes(*Open(path + "?frames=all", every_second).dataset), ElementsAre(1000, 3000));
  DatasetOptions few;
  few.max_frames = 3;
  EXPECT_THAT(Utimes(*Open(path + "?frames=all", few).dataset), ElementsAre(1000, 2000, 3000));
}

TEST(OpenRecording, IntrinsicsAndDepthUnitCanBeReplaced) {
  LogBuilder builder;
  const std::string path = builder.Frame(1000).Frame(2000).Finish();
  DatasetOptions options;
  options.intrinsics = {70, 71, 30, 20};
  options.depth_unit_m = 0.0005;
  const Recording recording = Open(path, options);
  ASSERT_EQ(recording.dataset->size(), 2u);
  const Result<SensorFrame> frame = recording.dataset->Read(1);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->header.camera, (PinholeCamera{64, 48, 70, 71, 30, 20}));
  EXPECT_EQ(recording.dataset->Header(1).camera, frame->header.camera);
  EXPECT_EQ(frame->depth_unit_m, 0.0005);
  EXPECT_THAT(recording.dataset->remarks(), ElementsAre(HasSubstr("the option --intrinsics")));
  options.intrinsics = {0, 71, 30, 20};
  EXPECT_THAT(OpenRecording(path, "", options).error().message, HasSubstr("--intrinsics: "));
  EXPECT_THAT(OpenRecording(path, "", {.registration = DepthRegistration::kKinect}).error().message,
              HasSubstr("--depth-registration"));
}

TEST(OpenRecording, RemarksSayWhyTheMapWillDiffer) {
  LogBuilder no_frame;
  EXPECT_THAT(Open(no_frame.Frame(1000).Commit(1000, 1).Commit(2000, 2).Finish()).remarks,
              ElementsAre(HasSubstr("the DETECTIONS of camera 3, utime 1000"),
                          HasSubstr("the RGBD_FRAME of camera 3, utime 2000")));
  LogBuilder continued;
  EXPECT_THAT(Open(continued.Frame(1000).Detections(1000).Commit(1000, 8).Finish()).remarks,
              ElementsAre(HasSubstr("no MAP_COMMIT of the revisions 1 to 7")));
}

TEST(OpenRecording, SkipsADamagedCopyOfAFrame) {
  LogBuilder builder;
  rgbd_frame_t message = Encode(SmallSensorFrame(1000));
  std::vector<uint8_t> damaged = Pack(message);
  damaged[damaged.size() - 50] ^= 1;
  builder.AddBytes("RGBD_FRAME", damaged).Frame(1000);
  const Recording recording = Open(builder.Finish());
  ASSERT_THAT(Utimes(*recording.dataset), ElementsAre(1000));
  EXPECT_TRUE(recording.dataset->Read(0));

  LogBuilder alone;
  const Recording broken = Open(alone.AddBytes("RGBD_FRAME", damaged).Finish());
  EXPECT_THAT(
      broken.dataset->Read(0).error().message,
      ::testing::AllOf(HasSubstr("run.lcmlog"), HasSubstr("checksum"), HasSubstr("utime 1000")));
}

rgbd_frame_t FrameAt(int64_t utime, double x) {
  rgbd_frame_t message = Encode(SmallSensorFrame(utime));
  message.T_W_C[3] = x;
  return message;
}

TEST(OpenRecording, OtherFramesWithAUsedTimeAreToldAndRepeatedOnesAreNot) {
  LogBuilder builder;
  for (const double x : {0.0, 0.0, 0.1, 0.2}) builder.Add(kRgbdFrameChannel, FrameAt(0, x));
  const Recording recording = Open(builder.Finish());
  EXPECT_THAT(Utimes(*recording.dataset), ElementsAre(0));
  EXPECT_THAT(SkippedReasons(*recording.dataset),
              ElementsAre(HasSubstr("another frame of camera 3, utime 0"),
                          HasSubstr("another frame of camera 3, utime 0")));
  EXPECT_EQ(recording.dataset->Header(0).T_W_C.translation().x(), 0);
}

TEST(OpenRecording, ADamagedCopyDoesNotHideTheGoodOne) {
  LogBuilder builder;
  rgbd_frame_t message = FrameAt(1000, 0.5);
  std::vector<uint8_t> damaged = Pack(message);
  damaged[damaged.size() - 50] ^= 1;
  builder.AddBytes("RGBD_FRAME", damaged).Add(kRgbdFrameChannel, FrameAt(1000, 0.25));
  const Recording recording = Open(builder.Finish());
  EXPECT_THAT(SkippedReasons(*recording.dataset), IsEmpty());
  ASSERT_THAT(Utimes(*recording.dataset), ElementsAre(1000));
  EXPECT_EQ(recording.dataset->Header(0).T_W_C.translation().x(), 0.25);
  EXPECT_TRUE(recording.dataset->Read(0));
}

TEST(OpenRecording, TellsWhereTheIntrinsicsComeFrom) {
  LogBuilder builder;
  EXPECT_THAT(
      Open(builder.Frame(1000, 3).Frame(2000, 5).Frame(3000, 5).Finish()).dataset->remarks(),
      ElementsAre(HasSubstr("camera 3: fx 52 fy 52 cx 31.5 cy 23.5 (64x48): from the RGBD"),
                  HasSubstr("camera 5: ")));
}

TEST(OpenRecording, RejectsInvalidRequests) {
  LogBuilder builder;
  const std::string path = builder.Frame(1000).Finish();
  const auto error_of = [](const std::string& name, const DatasetOptions& options = {}) {
    const Result<Recording> recording = OpenRecording(name, "", options);
    return recording ? "opened" : recording.error().message;
  };
  DatasetOptions camera;
  camera.camera_id = CameraId{2};
  EXPECT_THAT(error_of(path, camera), HasSubstr("keep their camera ids"));
  EXPECT_THAT(error_of(path + "?frames=some"), HasSubstr("frames=all"));
  EXPECT_THAT(error_of((builder.folder() / "missing.lcmlog").string()),
              HasSubstr("missing.lcmlog"));
  builder.folder().Write("empty.lcmlog", "");
  EXPECT_THAT(error_of((builder.folder() / "empty.lcmlog").string()), HasSubstr("no LCM event"));
  LogBuilder other;
  EXPECT_THAT(error_of(other.AddBytes("OTHER", {1, 2, 3}).Finish()),
              HasSubstr("the log has no RGBD_FRAME"));
}

TEST(IsLog, RecognizesLogsByNameAndContent) {
  LogBuilder builder("lcmlog-2026-01-01.00");
  const std::string path = builder.Frame(1000).Finish();
  EXPECT_TRUE(IsLog(path));
  EXPECT_TRUE(IsLog(path + "?frames=all"));
  EXPECT_TRUE(IsLog("/missing/run.lcmlog"));
  EXPECT_TRUE(IsLog("/missing/run.lcmlog.02?frames=all"));
  EXPECT_FALSE(IsLog("/missing/run.lcmlog.txt"));
  EXPECT_FALSE(IsLog(builder.folder().path().string()));
  EXPECT_FALSE(IsLog("synthetic:room?frames=3"));
}

TEST(OpenRecordedDetections, FrameWithoutDetectorDiffersFromFrameWithoutObjects) {
  LogBuilder builder;
  detections_t nothing = Encode(DetectionSet{2000, CameraId{3}, 17, {}}, 64, 48);
  builder.Frame(1000).Detections(1000).Frame(2000).Add(kDetectionsChannel, nothing);
  builder.Frame(3000).Frame(4000).Add(kDetectionsChannel,
                                      EncodeDetectorDidNotRun(SmallSensorFrame(4000).header));
  const auto source = OpenRecordedDetections(builder.Finish());
  ASSERT_TRUE(source) << source.error().message;
  const auto header = [](int64_t utime) { return SmallSensorFrame(utime).header; };
  EXPECT_TRUE((*source)->DetectorRan(header(1000)));
  const Result<DetectionSet> set = (*source)->ForFrame(header(1000));
  ASSERT_TRUE(set) << set.error().message;
  ASSERT_EQ(set->detections.size(), 2u);
  EXPECT_EQ(set->detections[0].class_id, ClassId{62});
  EXPECT_EQ(set->detections[0].mask, SmallDetections().detections[0].mask);
  EXPECT_TRUE((*source)->DetectorRan(header(2000)));
  EXPECT_THAT((*source)->ForFrame(header(2000))->detections, IsEmpty());
  EXPECT_FALSE((*source)->DetectorRan(header(3000)));
  EXPECT_FALSE((*source)->DetectorRan(header(4000)));
  EXPECT_FALSE((*source)->DetectorRan(SmallSensorFrame(1000, 4).header));
}

TEST(OpenRecordedDetections, LateDetectionsAreNotUsed) {
  LogBuilder builder;
  frame_commit_t without = builder.Committed(1000, 1);
  without.had_detections = false;
  builder.Frame(1000).Add(kMapCommitChannel, without).Detections(1000);
  builder.Frame(2000).Detections(2000).Commit(2000, 2);
  const std::string path = builder.Finish();
  const auto source = OpenRecordedDetections(path);
  EXPECT_FALSE((*source)->DetectorRan(SmallSensorFrame(1000).header));
  EXPECT_TRUE((*source)->DetectorRan(SmallSensorFrame(2000).header));
  const auto all = OpenRecordedDetections(path + "?frames=all");
  EXPECT_TRUE((*all)->DetectorRan(SmallSensorFrame(1000).header));
}

TEST(OpenRecordedDetections, MasksOfAnotherSizeAreAnError) {
  LogBuilder builder;
  const auto source = OpenRecordedDetections(builder.Frame(1000).Detections(1000).Finish());
  FrameHeader larger = SmallSensorFrame(1000).header;
  larger.camera.width = 640;
  EXPECT_THAT((*source)->ForFrame(larger).error().message, HasSubstr("64x48"));
}

// Every call must return: a mutated log gives an error or a sequence, in which some frames may give
// errors.
TEST(OpenRecording, NoMutatedLogCrashesIt) {
  LogBuilder builder;
  builder.Frame(1000).Detections(1000).Commit(1000, 1).Frame(2000).Detections(2000).Commit(2000, 2);
  const std::vector<uint8_t> good = *ReadFileBytes(builder.Finish());
  const TempFolder folder;
  const std::string path = (folder / "bad.lcmlog").string();
  int frames = 0;
  ForEachMutation(good, 2000, [&](const std::vector<uint8_t>& bad) {
    std::filesystem::remove(path);  // rewriting a file is slow on some file systems
    folder.Write("bad.lcmlog", std::span<const uint8_t>(bad));
    const Result<Recording> recording = OpenRecording(path, "");
    if (!recording) return;
    const auto source = OpenRecordedDetections(path);
    for (size_t i = 0; i < recording->dataset->size(); ++i) {
      const Result<SensorFrame> frame = recording->dataset->Read(i);
      if (!frame) continue;
      ++frames;
      if (source) (void)(*source)->ForFrame(frame->header);
    }
  });
  EXPECT_GT(frames, 1000);
}

}  // namespace
}  // namespace vismap
