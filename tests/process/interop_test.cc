#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <fstream>
#include <thread>
#include <vismap/frame_commit_t.hpp>

#include "config/config.h"
#include "datasets/scenenn_writer.h"
#include "logs/log_reader.h"
#include "logs/recording.h"
#include "process/room_pipeline.h"
#include "runtime/transport.h"

// Logs of DimOS, Drake and bot_core, made with their encoders (VISMAP_DATA/interop): a log, the
// same frames as a folder, and the log played to a running adapter give one map, bit for bit.

namespace vismap {
namespace {

struct InteropRun {
  const char* log;
  const char* adapter;  // section of the config
  bool raw_color;       // or JPEG
};
constexpr InteropRun kInteropRuns[] = {
    {"dimos_kitchen", "preset: DIMOS", true},
    {"dimos_kitchen_jpeg", "preset: DIMOS", false},
    {"botcore_kitchen", "preset: BOTCORE intrinsics: [585, 585, 320, 240]", false},
    {"drake_kitchen",
     "preset: DRAKE intrinsics: [585, 585, 320, 240] camera_frame: \"kitchen_camera::optical\"",
     true}};

class InteropMaps : public ::testing::TestWithParam<InteropRun> {
 protected:
  void SetUp() override {
    const char* root = std::getenv("VISMAP_DATA");
    if (root == nullptr) GTEST_SKIP() << "VISMAP_DATA is not set";
    log_ = std::string(root) + "/interop/" + GetParam().log + ".lcmlog";
    if (!std::filesystem::exists(log_)) GTEST_SKIP() << log_ << " is not there";
    // A slow computer may take long for a message; coarse voxels save its time.
    config_ = (processes_.folder() / "interop.txtpb").string();
    text_ = "grid { voxel_size_m: 0.03 } adapter { " + std::string(GetParam().adapter) +
            " wait_ms: 30000 intrinsics_wait_ms: 30000 }";
    std::ofstream(config_) << text_;
  }

  Result<Recording> Open() const {
    const Result<VismapConfig> config = ParseValidConfig(text_, config_);
    if (!config) return tl::unexpected(config.error());
    return OpenRecording(log_, "", {}, config->adapter);
  }

  std::string HashOf(const std::string& dataset) {
    return OfflineRoomHash("2", dataset, {"--config", config_, "--detections", "none"});
  }

  ProcessBus processes_;
  std::string log_, config_, text_;
};

/// Writes the frames of a sequence as a folder, with the same pixels and poses.
void WriteAsFolder(const Dataset& dataset, const std::filesystem::path& folder) {
  SceneNnWriter writer(folder);
  const FrameHeader first = dataset.Header(0);
  for (size_t i = 0; i < dataset.size(); ++i) {
    const Result<SensorFrame> frame = dataset.Read(i);
    ASSERT_TRUE(frame) << frame.error().message;
    FrameHeader header = frame->header;
    header.frame_number = static_cast<int64_t>(i) + 1;
    ASSERT_EQ(frame->color_encoding, ColorEncoding::kJpeg);
    writer.AddFrame(header, frame->depth, {".jpg", frame->color});
  }
  writer.Write("intrinsic/asus.ini", SceneNnIni(first.camera, 10, dataset.depth_unit_m()));
  const Result<void> finished = writer.Finish();
  ASSERT_TRUE(finished) << finished.error().message;
}

TEST_P(InteropMaps, AreThoseOfTheSameFramesAsADataset) {
  const std::string hash = HashOf(log_);
  EXPECT_EQ(hash.size(), 32u);
  const std::string ours = (processes_.folder() / "ours.lcmlog").string();
  ChildProcess convert("log", {"convert", log_, "--config", config_, "--out", ours},
                       processes_.folder());
  EXPECT_EQ(convert.WaitForExit(), 0) << convert.StandardError();
  EXPECT_EQ(HashOf(ours), hash);
  if (GetParam().raw_color) return;  // folders of images are read as JPEGs

  const Result<Recording> recording = Open();
  ASSERT_TRUE(recording) << recording.error().message;
  const std::filesystem::path folder = processes_.folder() / "kitchen";
  WriteAsFolder(*recording->dataset, folder);
  EXPECT_EQ(HashOf(folder.string()), hash);
}

TEST_P(InteropMaps, AreTheSameLive) {
  const Result<Recording> recording = Open();
  ASSERT_TRUE(recording) << recording.error().message;
  const int frames = static_cast<int>(recording->dataset->size());
  const std::string offline = HashOf(log_);
  int integrated = 0;
  processes_.bus().Subscribe<frame_commit_t>(kMapCommitChannel, [&](const frame_commit_t& commit) {
    if (commit.status == frame_commit_t::STATUS_INTEGRATED) ++integrated;
  });
  const std::vector<std::string> arguments = {"--config", config_};
  const auto server = processes_.Start("map-server", arguments);
  const auto segmenter =
      processes_.Start("depth-segmenter", {"--config", config_, "--detections", "none"});
  const auto adapter = processes_.Start("adapter", arguments);
  ASSERT_TRUE(processes_.WaitForReady({"map-server", "depth-segmenter", "adapter"}));

  LogReader reader = *LogReader::Open(log_);
  const auto robot = OpenTcpqTransport(ParseLcmUrl(processes_.url())->hub, nullptr);
  ASSERT_TRUE(robot) << robot.error().message;
  const Result<void> played = ForEachEvent(
      reader,
      [&](const LogEvent& event) -> Result<void> {
        const Result<std::vector<uint8_t>> bytes = reader.ReadData(event);
        if (!bytes) return tl::unexpected(bytes.error());
        EXPECT_TRUE((*robot)->Publish(event.channel, *bytes));
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
        return {};
      },
      [](const LogDamage&) {});
  ASSERT_TRUE(played) << played.error().message;
  EXPECT_TRUE(processes_.SpinUntil([&] { return integrated >= frames; })) << integrated;
  EXPECT_EQ(ServerStatistic(&processes_, "hash"), offline) << adapter->StandardError();
}

INSTANTIATE_TEST_SUITE_P(Logs, InteropMaps, ::testing::ValuesIn(kInteropRuns),
                         [](const auto& run) { return std::string(run.param.log); });

}  // namespace
}  // namespace vismap
