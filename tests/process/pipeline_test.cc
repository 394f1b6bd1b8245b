#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <set>
#include <vismap/detections_t.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "base/digest.h"
#include "process/process_harness.h"
#include "runtime/status.h"
#include "wire/frame_key.h"
#include "wire/segmented_frame.h"

// The processes before the map server; the test takes the place of the map server.

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr char kPipelineRoom[] = "synthetic:room?frames=12&width=160";
constexpr size_t kFrames = 12;

/// Takes the place of the map server: commits every frame and stores the messages.
class FakeMapServer {
 public:
  explicit FakeMapServer(ProcessBus* processes)
      : bus_(processes->bus()), status_(&bus_, "map-server") {
    bus_.Subscribe<segmented_frame_t>(
        kSegmentedFrameChannel, [this](const segmented_frame_t& message) { return Take(message); });
    status_.Set(ProcessState::kReady);
  }

  const std::map<FrameKey, uint64_t>& contents() const { return contents_; }
  const std::vector<FrameKey>& order() const { return order_; }
  int with_detections() const { return with_detections_; }
  int contradictions() const { return contradictions_; }
  /// Largest number of committed frames.
  size_t commit_limit = 1000;

 private:
  Result<void> Take(const segmented_frame_t& message) {
    const Result<SegmentedFrame> frame = Decode(message);
    if (!frame) return tl::unexpected(frame.error());
    const FrameKey key = KeyOf(message.frame);
    const uint64_t content = Checksum64(message.labels) ^ Checksum64(message.frame.depth);
    const auto [known, fresh] = contents_.try_emplace(key, content);
    if (fresh) {
      order_.push_back(key);
      with_detections_ += frame->had_detections ? 1 : 0;
    }
    contradictions_ += known->second == content ? 0 : 1;
    if (contents_.size() <= commit_limit) Commit(message);
    return {};
  }

  void Commit(const segmented_frame_t& message) {
    frame_commit_t commit{};
    commit.utime = message.utime;
    commit.camera_id = message.frame.camera_id;
    commit.frame_number = message.frame.frame_number;
    bus_.Publish(kMapCommitChannel, commit);
  }

  Bus& bus_;
  Status status_;
  std::map<FrameKey, uint64_t> contents_;
  std::vector<FrameKey> order_;
  int with_detections_ = 0;
  int contradictions_ = 0;
};

std::vector<std::string> Lockstep(const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {
      "--dataset", kPipelineRoom, "--mode", "lockstep",   "--window",
      "3",         "--resend-s",  "0.5",    "--wait-for", "depth-segmenter,detector,map-server"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// Runs the pipeline in lockstep until its end and disturbs it meanwhile.
void RunInLockstep(ProcessBus* processes, FakeMapServer* server) {
  auto segmenter = processes->Start("depth-segmenter", {"--detections", "required"});
  auto detector = processes->Start("detector", {"--dataset", kPipelineRoom});
  auto replay = processes->Start("sensor-replay", Lockstep());
  ASSERT_TRUE(processes->SpinUntil([&] { return !replay->Running(); })) << replay->StandardError();
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  EXPECT_EQ(server->order().size(), kFrames);
  EXPECT_TRUE(std::is_sorted(server->order().begin(), server->order().end()));
  EXPECT_EQ(server->with_detections(), static_cast<int>(kFrames));
  for (ChildProcess* process : {segmenter.get(), detector.get()}) {
    process->Signal(SIGTERM);
    EXPECT_EQ(process->WaitForExit(), 0) << process->StandardError();
  }
}

TEST(Pipeline, EveryFrameIsSegmentedWithItsDetectionsInOrder) {
  ProcessBus processes;
  FakeMapServer server(&processes);
  RunInLockstep(&processes, &server);
}

TEST(Pipeline, SmallSocketBuffersChangeNothing) {
  ProcessBus large, small({"--socket-buffer-bytes", "8192"});
  FakeMapServer a(&large), b(&small);
  RunInLockstep(&large, &a);
  RunInLockstep(&small, &b);
  EXPECT_EQ(a.contents(), b.contents());
}

TEST(Pipeline, ContinuesAfterSegmenterAndHubWereKilled) {
  ProcessBus processes;
  FakeMapServer server(&processes);
  server.commit_limit = 4;
  auto segmenter = processes.Start("depth-segmenter", {"--detections", "required"});
  auto detector = processes.Start("detector", {"--dataset", kPipelineRoom});
  auto replay = processes.Start("sensor-replay", Lockstep());
  ASSERT_TRUE(processes.SpinUntil([&] { return server.order().size() > 4; }))
      << replay->StandardError();
  segmenter->Signal(SIGKILL);
  segmenter->WaitForExit();
  segmenter = processes.Start("depth-segmenter", {"--detections", "required"});
  server.commit_limit = 8;
  ASSERT_TRUE(processes.SpinUntil([&] { return server.order().size() > 8; }))
      << replay->StandardError();
  processes.RestartHub();
  server.commit_limit = kFrames;
  ASSERT_TRUE(processes.SpinUntil([&] { return !replay->Running(); })) << replay->StandardError();
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  EXPECT_EQ(server.order().size(), kFrames);
  EXPECT_EQ(server.contradictions(), 0) << "a repeated frame gets the same segments";
}

TEST(Pipeline, WithoutADetectorFramesAreSegmentedByGeometryAlone) {
  ProcessBus processes;
  FakeMapServer server(&processes);
  auto segmenter = processes.Start("depth-segmenter");
  auto replay = processes.Start("sensor-replay", {"--dataset", kPipelineRoom, "--mode", "lockstep",
                                                  "--wait-for", "depth-segmenter,map-server"});
  ASSERT_TRUE(processes.SpinUntil([&] { return !replay->Running(); })) << replay->StandardError();
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  EXPECT_EQ(server.order().size(), kFrames);
  EXPECT_EQ(server.with_detections(), 0);
  EXPECT_TRUE(processes.SpinUntil([&] {
    const auto& all = processes.peers().all();
    return all.contains("depth-segmenter") &&
           all.at("depth-segmenter").message.find("no detector") != std::string::npos;
  })) << "its STATUS says so";
}

TEST(Pipeline, StatusOfTheSegmenterSaysForWhatItWaits) {
  ProcessBus processes;
  auto segmenter = processes.Start("depth-segmenter", {"--detections", "required"});
  ASSERT_TRUE(processes.WaitForReady({"depth-segmenter"}));
  auto replay = processes.Start("sensor-replay", {"--dataset", kPipelineRoom, "--max-frames", "1"});
  EXPECT_TRUE(processes.SpinUntil([&] {
    const Peer& peer = processes.peers().all().at("depth-segmenter");
    return peer.state == "waiting" &&
           peer.message.find("waiting for DETECTIONS") != std::string::npos;
  }));
}

TEST(Pipeline, InvalidMessagesStopNoProcess) {
  ProcessBus processes;
  FakeMapServer server(&processes);
  auto segmenter = processes.Start("depth-segmenter", {"--detections", "required"});
  auto detector = processes.Start("detector", {"--dataset", kPipelineRoom});
  ASSERT_TRUE(processes.WaitForReady({"depth-segmenter", "detector"}));
  for (int i = 0; i < 20; ++i) {
    detections_t foreign{};
    foreign.utime = -i;
    processes.bus().Publish({"RGBD_FRAME", kMegabyte}, foreign);
    processes.bus().Publish(kDetectionsChannel, foreign);
    rgbd_frame_t broken{};
    broken.color_camera.width = broken.color_camera.height = 16384;
    broken.depth_camera = broken.color_camera;
    processes.bus().Publish(kRgbdFrameChannel, broken);
    processes.bus().Publish({"SEGMENTED_FRAME", kMegabyte}, broken);
  }
  auto replay = processes.Start("sensor-replay", Lockstep());
  ASSERT_TRUE(processes.SpinUntil([&] { return !replay->Running(); })) << replay->StandardError();
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
  EXPECT_EQ(server.order().size(), kFrames);
  EXPECT_TRUE(segmenter->Running());
  EXPECT_TRUE(detector->Running());
}

TEST(Replay, FramesThatCouldNotBeSentAreAFailure) {
  ProcessBus processes;
  const auto replay = processes.Start(
      "sensor-replay",
      {"--dataset", "synthetic:room?frames=16&width=160", "--mode", "realtime", "--speed", "2"});
  int64_t received = 0;
  processes.bus().Subscribe<rgbd_frame_t>(kRgbdFrameChannel,
                                          [&](const rgbd_frame_t&) { ++received; });
  ASSERT_TRUE(processes.SpinUntil([&] { return received > 0; }));
  processes.StopHub();
  EXPECT_EQ(replay->WaitForExit(), 1);
  EXPECT_THAT(replay->StandardError(),
              HasSubstr("could not be sent, since there was no connection"));
}

TEST(Replay, StoppingBeforeTheLastCommitIsAFailure) {
  ProcessBus processes;
  FakeMapServer server(&processes);
  server.commit_limit = 2;
  auto segmenter = processes.Start("depth-segmenter", {"--detections", "none"});
  auto replay = processes.Start("sensor-replay", {"--dataset", kPipelineRoom, "--mode", "lockstep",
                                                  "--wait-for", "depth-segmenter,map-server"});
  ASSERT_TRUE(processes.SpinUntil([&] { return server.order().size() > 2; }))
      << replay->StandardError();
  replay->Signal(SIGINT);
  ASSERT_TRUE(processes.SpinUntil([&] { return !replay->Running(); }));
  EXPECT_EQ(replay->WaitForExit(), 1);
  EXPECT_THAT(replay->StandardError(), HasSubstr("had been committed"));
}

TEST(CommandLine, ExitCodesAreAsDocumented) {
  const TempFolder folder;
  folder.Write("broken.txtpb", "no_such_key: 1");
  const std::string config = (folder / "broken.txtpb").string();
  const struct {
    const char* program;
    std::vector<std::string> arguments;
    int code;
    const char* says;
  } cases[] = {
      {"sensor-replay", {"--help"}, 0, "--dataset"},
      {"depth-segmenter", {"--version"}, 0, "depth-segmenter"},
      {"depth-segmenter", {"--print-config"}, 0, "segmentation"},
      {"sensor-replay", {"--no-such-option", "--dataset", kPipelineRoom}, 2, "--no-such-option"},
      {"sensor-replay", {}, 2, "--dataset"},
      {"depth-segmenter", {"--config", config}, 2, "no_such_key"},
      {"depth-segmenter", {"--lcm-url", "tcpq://localhost:7700"}, 2, "127.0.0.1"},
      {"detector", {}, 2, "--detections"},
      {"detector", {"--backend", "dnn"}, 2, "--model"},
      {"detector",
       {"--backend", "dnn", "--model", "m.onnx", "--dataset", kPipelineRoom},
       2,
       "--dataset"},
      {"detector", {"--model", "/nowhere.onnx"}, 3, "/nowhere.onnx: no such file"},
      {"sensor-replay", {"--dataset", "/nowhere"}, 3, "/nowhere"},
      {"detector", {"--detections", "/nowhere.json"}, 3, "/nowhere.json"},
      {"depth-segmenter",
       {"--lcm-url", "tcpq://127.0.0.1:1", "--connect-timeout", "0.1"},
       1,
       "vismap-hub"},
      {"hub", {"--listen", "10.255.255.1:7700"}, 1, "10.255.255.1"},
      {"hub", {"--listen", "somewhere"}, 2, "somewhere"},
  };
  for (const auto& expected : cases) {
    ChildProcess process(expected.program, expected.arguments, folder.path());
    const std::string what = expected.program + std::string(" ") +
                             (expected.arguments.empty() ? "" : expected.arguments[0]);
    EXPECT_EQ(process.WaitForExit(), expected.code) << what << ": " << process.StandardError();
    EXPECT_THAT(process.StandardOutput() + process.StandardError(), HasSubstr(expected.says))
        << what;
  }
}

TEST(CommandLine, StopSignalEndsAWaitForTheHub) {
  const TempFolder folder;
  ChildProcess process("depth-segmenter",
                       {"--lcm-url", "tcpq://127.0.0.1:1", "--connect-timeout", "600"},
                       folder.path());
  const double deadline = 600;
  for (int i = 0;
       i < 1000 && process.StandardError().find("waiting for a hub") == std::string::npos; ++i) {
    usleep(10000);
  }
  process.Signal(SIGTERM);
  EXPECT_EQ(process.WaitForExit(deadline), 0) << process.StandardError();
}

}  // namespace
}  // namespace vismap
