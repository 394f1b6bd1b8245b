#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>
#include <vismap/frame_commit_t.hpp>
#include <vismap/process_status_t.hpp>

#include "logs/log_writer.h"
#include "logs/recording.h"
#include "process/process_harness.h"
#include "runtime/clock.h"
#include "simulation/sequence.h"
#include "wire/detections.h"
#include "wire/frame_key.h"
#include "wire/rgbd_frame.h"

// Runs recorded with LCM's own logger, and the use of these logs.

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr char kLogger[] = "/usr/bin/lcm-logger";
constexpr char kLogPlayer[] = "/usr/bin/lcm-logplayer";
constexpr char kLoggedRoom[] = "synthetic:room?frames=12&width=96";

/// Standard output of one of our programs; the test fails unless it ends with `exit_code`.
std::string RunTool(const std::string& tool, const std::vector<std::string>& arguments,
                    const TempFolder& folder, int exit_code = 0) {
  ChildProcess child(tool, arguments, folder.path());
  EXPECT_EQ(child.WaitForExit(), exit_code) << tool << ": " << child.StandardError();
  return child.StandardOutput();
}

std::string OfflineHash(const std::string& dataset, const TempFolder& folder) {
  RunTool("offline-mapper", {"--dataset", dataset, "--out", (folder / "out").string()}, folder);
  std::ifstream report(folder / "out/report.json");
  return nlohmann::json::parse(report)["map"]["hash"].get<std::string>();
}

/// The processes that build a map.
struct Pipeline {
  Pipeline(ProcessBus* bus, const std::string& threads) : processes(bus) {
    server = processes->Start("map-server", {"--threads", threads});
    segmenter =
        processes->Start("depth-segmenter", {"--threads", threads, "--detections", "required"});
    processes->bus().Subscribe<frame_commit_t>(
        kMapCommitChannel,
        [this](const frame_commit_t& commit) { order.push_back(KeyOf(commit)); });
  }
  /// Replays a sequence with its own detections in lockstep until its end.
  void Play(const std::string& dataset, const std::vector<std::string>& options) {
    detector = processes->Start("detector", {"--dataset", dataset});
    std::vector<std::string> arguments{"--dataset", dataset, "--wait-for",
                                       "map-server,depth-segmenter,detector"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto replay = processes->Start("sensor-replay", arguments);
    ASSERT_TRUE(processes->SpinUntil([&] { return !replay->Running(); }));
    EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  }
  std::string Hash() {
    const auto tool = processes->Start("map", {"hash", "live"});
    EXPECT_EQ(tool->WaitForExit(), 0) << tool->StandardError();
    const std::string hash = tool->StandardOutput();
    return hash.substr(0, hash.find('\n'));
  }
  void Stop() {
    for (ChildProcess* process : {server.get(), segmenter.get(), detector.get()}) {
      if (process == nullptr) continue;
      process->Signal(SIGTERM);
      EXPECT_EQ(process->WaitForExit(), 0) << process->StandardError();
    }
  }

  ProcessBus* processes;
  std::unique_ptr<ChildProcess> server, segmenter, detector;
  std::vector<FrameKey> order;  // of the commits
};

/// A running lcm-logger, used as the README says: started first, and stopped last when all messages
/// are written.
class Recorder {
 public:
  Recorder(ProcessBus* processes, std::filesystem::path log)
      : processes_(processes), log_(std::move(log)) {
    logger_ = std::make_unique<ChildProcess>(
        kLogger, std::vector<std::string>{"--lcm-url=" + processes->url(), "-f", log_.string()},
        processes->folder());
    // It has written something, so it records.
    constexpr Channel kProbe{"RECORDER_PROBE", kMegabyte};
    EXPECT_TRUE(processes_->SpinUntil([&] {
      processes_->bus().Publish(kProbe, process_status_t{});
      return Size() > 0;
    }));
  }
  /// Stops the recording when all earlier messages are written. This is so when the log has grown
  /// by a later message, for example by a STATUS of the hub.
  void Stop() {
    uintmax_t size = Size();
    int grown = 0;
    EXPECT_TRUE(processes_->SpinUntil([&] {
      const uintmax_t before = std::exchange(size, Size());
      if (size != before) ++grown;
      return grown == 2;
    }));
    logger_->Signal(SIGINT);
    EXPECT_EQ(logger_->WaitForExit(), 0) << logger_->StandardError();
  }

 private:
  uintmax_t Size() const {
    std::error_code missing;
    const uintmax_t size = std::filesystem::file_size(log_, missing);
    return missing ? 0 : size;
  }
  ProcessBus* processes_;
  std::filesystem::path log_;
  std::unique_ptr<ChildProcess> logger_;
};

/// Replays a sequence in lockstep and records it; returns the hash of the live map.
std::string RecordedHash(const std::string& dataset, const std::string& threads,
                         const std::vector<std::string>& options,
                         const std::filesystem::path& log) {
  ProcessBus processes({"--lossless", ".*"});  // so that the recorder receives every message
  Recorder recorder(&processes, log);
  Pipeline pipeline(&processes, threads);
  pipeline.Play(dataset, options);
  const std::string hash = pipeline.Hash();
  pipeline.Stop();
  recorder.Stop();
  return hash;
}

TEST(Logs, RunRecordedByLcmLoggerGivesTheSameMap) {
  if (!std::filesystem::exists(kLogger)) GTEST_SKIP() << "needs " << kLogger << " (liblcm-bin)";
  const TempFolder folder;
  const std::string log = (folder / "run.lcmlog").string();
  const std::string again = (folder / "again.lcmlog").string();
  const std::string hash = RecordedHash(kLoggedRoom, "2", {"--mode", "lockstep"}, log);
  const std::string report = RunTool("log", {"verify", log}, folder);
  EXPECT_THAT(
      report,
      HasSubstr(
          "12 sent, 12 integrated, 0 skipped\nno message is lost, and the log is not damaged"));
  EXPECT_EQ(OfflineHash(log, folder), hash);
  EXPECT_EQ(OfflineHash(log + "?frames=all", folder), hash);
  // A log is replayed in lockstep by default.
  EXPECT_EQ(RecordedHash(log, "1", {}, again), hash);
  EXPECT_THAT(RunTool("map", {"compare-runs", log, again}, folder), HasSubstr("equal"));
  ProcessBus processes;
  Pipeline pipeline(&processes, "2");
  pipeline.Play(again, {});
  EXPECT_EQ(pipeline.Hash(), hash);
}

/// Frames of the room from two alternating cameras. According to the log, the map was built from
/// them in another order, and from every third one without its detections.
std::vector<FrameKey> WriteStrangeRun(const std::filesystem::path& path) {
  const auto dataset = *OpenSequence("synthetic:room?frames=8&width=96", "");
  const auto detections = *OpenDetections(dataset->default_detections_path().value());
  LogWriter writer = *LogWriter::Create(path);
  std::vector<FrameKey> frames;
  for (size_t i = 0; i < dataset->size(); ++i) {
    SensorFrame frame = *dataset->Read(i);
    frame.header.camera_id = CameraId{static_cast<int32_t>(i % 2)};
    frames.push_back({frame.header.camera_id, frame.header.utime});
    rgbd_frame_t message = Encode(frame);
    writer.Add(0, kRgbdFrameChannel.name, Pack(message));
    detections_t found = Encode(*detections->ForFrame(frame.header), 96, 72);
    writer.Add(0, kDetectionsChannel.name, Pack(found));
  }
  std::vector<FrameKey> order;
  for (const size_t i : {2, 0, 1, 3, 4, 7, 5}) {  // 6 was not integrated
    frame_commit_t commit{};
    commit.camera_id = Raw(frames[i].camera_id);
    commit.utime = frames[i].utime;
    commit.map_id = "recorded";
    order.push_back(frames[i]);
    commit.revision = static_cast<int64_t>(order.size());
    commit.had_detections = i % 3 != 0;
    writer.Add(0, kMapCommitChannel.name, Pack(commit));
  }
  EXPECT_TRUE(writer.Finish());
  return order;
}

TEST(Logs, ReplayKeepsTheOrderOfCommitsAndFramesWithoutDetections) {
  const TempFolder folder;
  const std::string log = (folder / "strange.lcmlog").string();
  const std::vector<FrameKey> order = WriteStrangeRun(log);
  const std::string offline = OfflineHash(log, folder);
  EXPECT_NE(OfflineHash(log + "?frames=all", folder), offline);
  ProcessBus processes;
  Pipeline pipeline(&processes, "2");
  pipeline.Play(log, {"--window", "4"});
  EXPECT_EQ(pipeline.order, order);
  EXPECT_EQ(pipeline.Hash(), offline);
  RunTool("detector", {"--dataset", log, "--check"}, folder);
}

TEST(Logs, LcmLogplayerReplaysIntoRunningProcesses) {
  if (!std::filesystem::exists(kLogPlayer)) GTEST_SKIP() << "needs " << kLogPlayer;
  const TempFolder folder;
  const std::string log = (folder / "inputs.lcmlog").string();
  RunTool("log", {"from-dataset", kLoggedRoom, "--out", log}, folder);
  ProcessBus processes;
  Pipeline pipeline(&processes, "2");
  ASSERT_TRUE(processes.WaitForReady({"map-server", "depth-segmenter"}));
  const double start = MonotonicSeconds();
  ChildProcess player(kLogPlayer, {"--lcm-url=" + processes.url(), log}, folder.path());
  ASSERT_TRUE(processes.SpinUntil([&] { return pipeline.order.size() == 12; }));
  EXPECT_GT(MonotonicSeconds() - start, 1.0);  // 12 frames at 10 per second
  EXPECT_EQ(player.WaitForExit(), 0) << player.StandardError();
  EXPECT_EQ(pipeline.Hash(), OfflineHash(log, folder));
}

TEST(Logs, FolderOfTheSameFramesGivesTheSameMap) {
  const TempFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  RunTool("log", {"from-dataset", "synthetic:room?frames=4&width=96", "--out", path("a.lcmlog")},
          folder);
  RunTool("log", {"to-dataset", path("a.lcmlog"), "--out", path("sequence")}, folder);
  RunTool("log", {"from-dataset", path("sequence"), "--out", path("b.lcmlog")}, folder);
  RunTool("log", {"verify", path("b.lcmlog")}, folder);
  const std::string hash = OfflineHash(path("a.lcmlog"), folder);
  EXPECT_EQ(OfflineHash(path("sequence"), folder), hash);
  EXPECT_EQ(OfflineHash(path("b.lcmlog"), folder), hash);
}

TEST(Logs, CalibrationThatIsGivenReplacesThatOfTheFolder) {
  const TempFolder folder;
  const auto path = [&](const char* name) { return (folder / name).string(); };
  RunTool("log", {"from-dataset", "synthetic:room?frames=2&width=96", "--out", path("a.lcmlog")},
          folder);
  RunTool("log", {"to-dataset", path("a.lcmlog"), "--out", path("sequence")}, folder);
  RunTool("log",
          {"from-dataset", path("sequence"), "--out", path("b.lcmlog"), "--intrinsics",
           "70,71,47,35", "--depth-unit", "0.0005"},
          folder);
  const Result<Recording> recording = OpenRecording(path("b.lcmlog"), "");
  ASSERT_TRUE(recording) << recording.error().message;
  const Result<SensorFrame> frame = recording->dataset->Read(0);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_EQ(frame->header.camera, (PinholeCamera{96, 72, 70, 71, 47, 35}));
  EXPECT_EQ(frame->depth_unit_m, 0.0005);
  RunTool("log",
          {"from-dataset", path("sequence"), "--out", path("c.lcmlog"), "--intrinsics", "70,71"},
          folder, 2);
}

TEST(Logs, AnExportThatIsInterruptedEndsAtTheFirstSignalWithoutAFile) {
  const TempFolder folder;
  const std::filesystem::path out = folder / "run.mcap", part = folder / "run.mcap.part";
  ChildProcess tool("log",
                    {"to-mcap", "synthetic:office?frames=100000", "--map", "--out", out.string()},
                    folder.path());
  const double end = MonotonicSeconds() + kProcessDeadline;
  while (!std::filesystem::exists(part) && MonotonicSeconds() < end) usleep(20000);
  ASSERT_TRUE(std::filesystem::exists(part)) << tool.StandardError();
  tool.Signal(SIGINT);
  EXPECT_EQ(tool.WaitForExit(), 1);
  EXPECT_THAT(tool.StandardError(), HasSubstr("stopped before the end; no file was written"));
  EXPECT_FALSE(std::filesystem::exists(out) || std::filesystem::exists(part));
}

TEST(Logs, CorruptLogsGiveErrors) {
  const TempFolder folder;
  const std::string log = (folder / "bad.lcmlog").string();
  const std::string out = (folder / "out").string();
  folder.Write("bad.lcmlog", "\xed\xa1\xda\x01 this is no log");
  RunTool("log", {"verify", log}, folder, 3);
  RunTool("log", {"cut", log, "--out", out}, folder, 3);
  RunTool("log", {"to-dataset", log, "--out", out}, folder, 3);
  RunTool("offline-mapper", {"--dataset", log, "--out", out}, folder, 3);
  RunTool("sensor-replay", {"--dataset", log}, folder, 3);
  RunTool("detector", {"--dataset", log, "--check"}, folder, 3);
  RunTool("map", {"compare-runs", log, log}, folder, 3);
}

}  // namespace
}  // namespace vismap
