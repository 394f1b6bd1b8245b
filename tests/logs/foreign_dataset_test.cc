#include "logs/foreign_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "logs/log_reader.h"
#include "logs/log_writer.h"
#include "logs/recording.h"
#include "support/foreign_builder.h"
#include "support/log_builder.h"

namespace vismap {
namespace {

using namespace foreign_test;  // NOLINT
using ::testing::HasSubstr;

constexpr int64_t kLogStart = 1'760'000'000'000'000;

/// A log of a DimOS robot with `frames` frames at 10 Hz.
std::string DimosLog(const TempFolder& folder, int frames) {
  const std::string path = (folder / "dimos.lcmlog").string();
  LogWriter writer = *LogWriter::Create(path);
  writer.Add(kLogStart, kInfoChannel, CameraInfo(kLogStart));
  for (int tick = -1; tick <= 5 * frames + 1; ++tick) {
    const int64_t now = kLogStart + tick * 20'000 + 6000;
    writer.Add(now, kTfChannel,
               Tf({Transform(now, "world", "base_link", BodyAt(now - kLogStart)),
                   Transform(now, "base_link", "optical", OpticalInBody())}));
    if (tick < 0 || tick % 5 != 0 || tick >= 5 * frames) continue;
    const int64_t utime = now + 4000;
    writer.Add(utime, kColorChannel, ColorImage(utime));
    writer.Add(utime + 1, kDepthChannel, DepthImage(utime + 750));
  }
  EXPECT_TRUE(writer.Finish());
  return path;
}

TEST(ForeignDataset, IsOpenedWithoutAConfig) {
  const TempFolder folder;
  const std::string path = DimosLog(folder, 5);
  const Result<Recording> recording = OpenRecording(path, "");
  ASSERT_TRUE(recording) << recording.error().message;
  const Dataset& dataset = *recording->dataset;
  ASSERT_EQ(dataset.size(), 5u);
  EXPECT_THAT(dataset.remarks(), ::testing::Contains(HasSubstr("preset DIMOS")));
  const Result<SensorFrame> frame = dataset.Read(3);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->header.utime, kLogStart + 310'000);
  EXPECT_EQ(frame->header.utime, dataset.Header(3).utime);
  EXPECT_EQ(frame->header.camera, dataset.Header(3).camera);
  EXPECT_EQ(frame->depth, SmallSensorFrame().depth);
  EXPECT_TRUE(frame->header.T_W_C.isApprox(BodyAt(310'000) * OpticalInBody(), 1e-4));
}

TEST(ForeignDataset, TakesEveryNthFrameAndAtMostSoMany) {
  const TempFolder folder;
  const std::string path = DimosLog(folder, 8);
  DatasetOptions options;
  options.stride = 3;
  options.max_frames = 2;
  const Result<Recording> recording = OpenRecording(path, "", options);
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(recording->dataset->size(), 2u);
  EXPECT_EQ(recording->dataset->Header(1).utime, kLogStart + 310'000);
}

/// The same log with another time of one event.
std::string WithEventAt(const TempFolder& folder, const std::string& log, int event, int64_t time) {
  const std::string path = (folder / "changed.lcmlog").string();
  LogWriter writer = *LogWriter::Create(path);
  LogReader reader = *LogReader::Open(log);
  int number = 0;
  const Result<void> read = ForEachEvent(
      reader,
      [&](const LogEvent& at) -> Result<void> {
        writer.Add(number++ == event ? time : at.timestamp, at.channel, *reader.ReadData(at));
        return {};
      },
      [](const LogDamage&) {});
  EXPECT_TRUE(read && writer.Finish());
  return path;
}

TEST(ForeignDataset, AnEventWithAWrongTimeCostsNoFrame) {
  const TempFolder folder;
  const std::string path = DimosLog(folder, 5);
  for (const int64_t time : {int64_t{0}, kLogStart + 3'600'000'000, int64_t{1} << 61}) {
    const Result<Recording> recording = OpenRecording(WithEventAt(folder, path, 9, time), "");
    ASSERT_TRUE(recording) << recording.error().message;
    EXPECT_EQ(recording->dataset->size(), 5u) << time;
    EXPECT_THAT(recording->dataset->remarks(),
                ::testing::Contains(HasSubstr("ignored: 1 x the log has a message at a time")));
  }
}

TEST(ForeignDataset, UsesTheCameraOfTheCommandLine) {
  const TempFolder folder;
  DatasetOptions options;
  options.intrinsics = {50, 50, 32, 24};
  options.depth_unit_m = 0.0005;
  options.camera_id = CameraId{4};
  const Result<Recording> recording = OpenRecording(DimosLog(folder, 3), "", options);
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->dataset->Header(0).camera.fx, 50);
  EXPECT_EQ(recording->dataset->Header(0).camera_id, CameraId{4});
  EXPECT_EQ(recording->dataset->Read(0)->depth_unit_m, 0.0005);
}

TEST(ForeignDataset, ReadsSeveralCameras) {
  const TempFolder folder;
  const std::string right_depth = "/right/depth_image#sensor_msgs.Image";
  const std::string path = (folder / "two.lcmlog").string();
  LogWriter writer = *LogWriter::Create(path);
  writer.Add(kLogStart, kInfoChannel, CameraInfo(kLogStart));
  for (int tick = -1; tick <= 16; ++tick) {
    const int64_t now = kLogStart + tick * 20'000 + 6000;
    writer.Add(now, kTfChannel,
               Tf({Transform(now, "world", "base_link", BodyAt(now - kLogStart)),
                   Transform(now, "base_link", "optical", OpticalInBody())}));
    if (tick < 0 || tick % 5 != 0) continue;
    const int64_t utime = now + 4000;
    writer.Add(utime, kDepthChannel, DepthImage(utime));
    writer.Add(utime + 1, right_depth, DepthImage(utime));
  }
  ASSERT_TRUE(writer.Finish());
  AdapterOptions adapter;
  AdapterCameraOptions left;
  left.preset = AdapterPreset::kDimos;
  left.color_channel = "none";
  AdapterCameraOptions right = left;
  right.camera_id = 5;
  right.depth_channel = right_depth;
  right.depth_unit_m = 0.0005;
  adapter.camera = {left, right};
  const Result<Recording> recording = OpenRecording(path, "", {}, adapter);
  ASSERT_TRUE(recording) << recording.error().message;
  const Dataset& dataset = *recording->dataset;
  ASSERT_EQ(dataset.size(), 8u);
  EXPECT_EQ(dataset.Header(0).camera_id, CameraId{0});
  EXPECT_EQ(dataset.Header(1).camera_id, CameraId{5});
  EXPECT_EQ(dataset.Header(0).utime, dataset.Header(1).utime);
  EXPECT_EQ(dataset.Read(0)->depth_unit_m, 0.001);
  EXPECT_EQ(dataset.Read(1)->depth_unit_m, 0.0005);
  EXPECT_THAT(dataset.remarks(), ::testing::Contains(HasSubstr("camera 5: ")));

  DatasetOptions options;
  options.camera_id = CameraId{2};
  const Result<Recording> wrong = OpenRecording(path, "", options, adapter);
  ASSERT_FALSE(wrong);
  EXPECT_THAT(wrong.error().message, HasSubstr("several cameras"));
}

TEST(ForeignDataset, SaysWhatIsMissing) {
  const TempFolder folder;
  AdapterOptions adapter;
  adapter.root = "map";
  const Result<Recording> unknown_root = OpenRecording(DimosLog(folder, 3), "", {}, adapter);
  ASSERT_FALSE(unknown_root);
  EXPECT_THAT(unknown_root.error().message, HasSubstr("connect the frame 'optical' with 'map'"));

  const std::string path = (folder / "bot.lcmlog").string();
  LogWriter writer = *LogWriter::Create(path);
  writer.Add(kLogStart, "OPENNI_FRAME", BotImages(kLogStart, kLogStart));
  ASSERT_TRUE(writer.Finish());
  const Result<Recording> no_intrinsics = OpenRecording(path, "");
  ASSERT_FALSE(no_intrinsics);
  EXPECT_THAT(no_intrinsics.error().message, HasSubstr("preset BOTCORE: adapter.intrinsics"));
}

TEST(ForeignDataset, OwnFramesOfALogComeFirst) {
  LogBuilder log;
  log.AddBytes(kInfoChannel, CameraInfo(1)).Frame(1000).AddBytes(kDepthChannel, DepthImage(5));
  const Result<Recording> recording = OpenRecording(log.Finish(), "");
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->dataset->size(), 1u);
  EXPECT_EQ(recording->dataset->Header(0).utime, 1000);
}

// ---- The logs below VISMAP_DATA/interop, made with the encoders of these programs.

struct InteropLog {
  const char* name;
  AdapterOptions adapter;
  std::string depth_channel;
};

AdapterOptions Given(const std::string& camera_frame) {
  AdapterOptions adapter;
  adapter.intrinsics = {585, 585, 320, 240};
  adapter.camera_frame = camera_frame;
  return adapter;
}

const char* const kMount =
    " 0.219348034 0.024986417 0.309664973 0.459191736 -0.561969485 "
    "0.534400399 -0.433300659";

std::vector<InteropLog> InteropLogs() {
  AdapterOptions by_body = Given("");
  by_body.pose_channels = {"POSE_BODY"};
  by_body.mounts = {"body OPENNI_FRAME_LEFT" + std::string(kMount)};
  AdapterOptions by_base = Given("optical");
  by_base.mounts = {"robot::base_link optical" + std::string(kMount)};
  const std::string drake = "DRAKE_RGBD_CAMERA_IMAGES_kitchen";
  return {{"dimos_kitchen", {}, kDepthChannel},
          {"dimos_kitchen_jpeg", {}, kDepthChannel},
          {"botcore_kitchen", Given(""), "OPENNI_FRAME"},
          {"botcore_kitchen", by_body, "OPENNI_FRAME"},
          {"drake_kitchen", Given("kitchen_camera::optical"), drake},
          {"drake_kitchen", by_base, drake}};
}

/// Number of messages of a channel.
size_t CountMessages(const std::string& path, const std::string& channel) {
  LogReader reader = *LogReader::Open(path);
  size_t count = 0;
  const auto read = ForEachEvent(
      reader,
      [&](const LogEvent& event) -> Result<void> {
        count += event.channel == channel ? 1 : 0;
        return {};
      },
      [](const LogDamage&) {});
  EXPECT_TRUE(read);
  return count;
}

/// utime -> T_W_C of a truth file.
std::map<int64_t, Pose> ReadTruth(const std::string& path) {
  std::map<int64_t, Pose> truth;
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream words(line);
    int64_t k = 0, frame = 0, utime = 0, depth_utime = 0;
    words >> k >> frame >> utime >> depth_utime;
    Pose pose;
    for (int i = 0; i < 16; ++i) words >> pose.matrix()(i / 4, i % 4);
    if (words) truth[utime] = pose;
  }
  return truth;
}

class InteropData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("VISMAP_DATA");
    if (root == nullptr) GTEST_SKIP() << "VISMAP_DATA is not set";
    folder_ = std::string(root) + "/interop/";
    if (!std::filesystem::exists(folder_)) GTEST_SKIP() << folder_ << " is not there";
  }
  std::string folder_;
};

TEST_F(InteropData, PosesAreThoseOfTheTruth) {
  for (const InteropLog& log : InteropLogs()) {
    const auto recording = OpenRecording(folder_ + log.name + ".lcmlog", "", {}, log.adapter);
    ASSERT_TRUE(recording) << log.name << ": " << recording.error().message;
    const Dataset& dataset = *recording->dataset;
    EXPECT_EQ(dataset.size(), CountMessages(folder_ + log.name + ".lcmlog", log.depth_channel))
        << log.name;
    EXPECT_GE(dataset.size(), 4u) << log.name;
    const std::map<int64_t, Pose> truth = ReadTruth(folder_ + log.name + ".truth.txt");
    double worst_mm = 0, worst_deg = 0;
    for (size_t i = 0; i < dataset.size(); ++i) {
      const FrameHeader header = dataset.Header(i);
      ASSERT_TRUE(truth.contains(header.utime)) << log.name << ", frame " << i;
      const Pose error = truth.at(header.utime).inverse() * header.T_W_C;
      worst_mm = std::max(worst_mm, 1e3 * error.translation().norm());
      worst_deg = std::max(worst_deg, Eigen::AngleAxisd(error.rotation()).angle() * 180 / M_PI);
    }
    RecordProperty(std::string(log.name) + "_mm", std::to_string(worst_mm));
    std::printf("%s: %zu frames, %.3f mm, %.4f deg\n", log.name, dataset.size(), worst_mm,
                worst_deg);
    EXPECT_LT(worst_mm, 1) << log.name;
    EXPECT_LT(worst_deg, 0.05) << log.name;
  }
}

TEST_F(InteropData, ImagesAreThoseOfTheSequence) {
  DatasetOptions options;
  options.registration = DepthRegistration::kRegistered;  // as the logs have it
  const auto original = OpenDataset(folder_ + "../7scenes", "", options);
  ASSERT_TRUE(original) << original.error().message;
  for (const InteropLog& log : InteropLogs()) {
    const auto recording = OpenRecording(folder_ + log.name + ".lcmlog", "", {}, log.adapter);
    ASSERT_TRUE(recording) << log.name << ": " << recording.error().message;
    for (const size_t i : {size_t{0}, recording->dataset->size() - 1}) {
      const Result<SensorFrame> frame = recording->dataset->Read(i);
      ASSERT_TRUE(frame) << log.name << ": " << frame.error().message;
      bool found = false;
      for (size_t k = 0; k < (*original)->size() && !found; ++k) {
        if ((*original)->Header(k).frame_number != static_cast<int64_t>(4 + 2 * i)) continue;
        found = true;
        EXPECT_EQ(frame->depth, (*original)->Read(k)->depth) << log.name << ", frame " << i;
      }
      EXPECT_TRUE(found) << log.name << ", frame " << i;
    }
  }
}

}  // namespace
}  // namespace vismap
