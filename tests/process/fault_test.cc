#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>
#include <vismap/frame_commit_t.hpp>
#include <vismap/process_status_t.hpp>

#include "base/file.h"
#include "codecs/frame_codec.h"
#include "process/room_pipeline.h"
#include "simulation/sequence.h"
#include "wire/rgbd_frame.h"

// What may go wrong on a robot: processes crash, messages are lost, disks are full, clocks jump.
// The other processes continue, a restarted process catches up, and the map is the same.

namespace vismap {
namespace {

using ::testing::HasSubstr;

/// A server that saves often and continues the saved map after a crash.
std::vector<std::string> RecoveringServer(const ProcessBus& processes) {
  const std::string config = (processes.folder() / "server.txtpb").string();
  std::ofstream(config) << "map_server { recover: true save_period_s: 0.2 save_on_exit: \""
                        << (processes.folder() / "kept.vismap").string() << "\" }";
  return {"--config", config};
}

int64_t Counter(const process_status_t& status, const std::string& name) {
  for (size_t i = 0; i < status.counter_names.size(); ++i) {
    if (status.counter_names[i] == name) return status.counter_values[i];
  }
  return 0;
}

TEST(Faults, MapIsTheSameAfterEveryProcessWasKilled) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.server_arguments = RecoveringServer(processes);
  pipeline.Start();
  ASSERT_TRUE(pipeline.WaitForFrames(3));
  Crash(pipeline.detector.get());
  pipeline.StartDetector();
  ASSERT_TRUE(pipeline.WaitForFrames(5));
  Crash(pipeline.segmenter.get());
  pipeline.StartSegmenter();
  ASSERT_TRUE(pipeline.WaitForFrames(7));
  Crash(pipeline.exporter.get());
  pipeline.StartExporter();
  ASSERT_TRUE(pipeline.WaitForFrames(9));
  processes.RestartHub();
  ASSERT_TRUE(pipeline.WaitForFrames(11));
  Crash(pipeline.server.get());
  pipeline.StartServer();
  pipeline.WaitForEnd();
  EXPECT_EQ(ServerStatistic(&processes, "hash"), OfflineRoomHash());
  EXPECT_EQ(Ask(&processes, "frames").revision, RoomPipeline::kFrames)
      << "no frame was integrated twice";
  ExpectExporterIsLevel(&processes);
}

TEST(Faults, MapServerWithoutSavedMapGetsAllFramesAgain) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.Start();
  ASSERT_TRUE(pipeline.WaitForFrames(6));
  Crash(pipeline.server.get());
  pipeline.StartServer();
  pipeline.WaitForEnd();
  EXPECT_EQ(Ask(&processes, "frames").revision, RoomPipeline::kFrames);
  EXPECT_THAT(pipeline.replay->StandardError(), HasSubstr("sending again from frame "));
  ExpectExporterIsLevel(&processes);
}

TEST(Faults, RecoveredMapServerReportsMissingFrames) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.server_arguments = RecoveringServer(processes);
  pipeline.Start();
  pipeline.WaitForEnd();
  // The journal of a server that was killed after it had integrated three more frames.
  pipeline.server->Signal(SIGTERM);
  EXPECT_EQ(pipeline.server->WaitForExit(), 0) << pipeline.server->StandardError();
  std::ofstream(processes.folder() / "kept.vismap.journal") << "0 91\n0 92\n0 93\n0 9";
  std::optional<process_status_t> last;
  processes.bus().Subscribe<process_status_t>(kStatusChannel, [&](const process_status_t& status) {
    if (status.process == "map-server") last = status;
  });
  pipeline.StartServer();
  EXPECT_TRUE(processes.SpinUntil([&] { return last && Counter(*last, "frames_lacking") == 3; }));
  EXPECT_THAT(last->message, HasSubstr("3 frames"));
  EXPECT_EQ(Ask(&processes, "frames").revision, RoomPipeline::kFrames);
}

TEST(Faults, AllCopiesEqualTheServerAlthoughFivePercentOfMessagesAreLost) {
  ProcessBus processes({"--drop-fraction", "0.05", "--drop-seed", "3"});
  RoomPipeline pipeline(&processes);
  pipeline.Start();
  const std::string mesh = (processes.folder() / "mesh.ply").string();
  const auto viewer = processes.Start("map", {"follow", "--out", mesh, "--name", "viewer"});
  pipeline.WaitForEnd();
  auto late_viewer = processes.Start("map", {"follow", "--frames", "16", "--name", "late"});
  EXPECT_EQ(ServerStatistic(&processes, "hash"), OfflineRoomHash());
  ExpectExporterIsLevel(&processes);
  Crash(pipeline.exporter.get());
  pipeline.StartExporter();
  ExpectExporterIsLevel(&processes);

  const std::string truth = "mesh digest " + Ask(&processes, "mesh", "digest").message;
  EXPECT_TRUE(processes.SpinUntil([&] { return !late_viewer->Running(); }));
  EXPECT_THAT(late_viewer->StandardOutput(), HasSubstr(truth));
  EXPECT_TRUE(processes.SpinUntil(
      [&] { return viewer->StandardOutput().find(": 16 frames") != std::string::npos; }));
  viewer->Signal(SIGINT);
  EXPECT_EQ(viewer->WaitForExit(), 0) << viewer->StandardError();
  EXPECT_THAT(viewer->StandardOutput(), HasSubstr(truth));
  EXPECT_GT(std::filesystem::file_size(mesh), 10000u);
}

TEST(Faults, FullDiskDamagesNeitherTheOldMapNorTheServer) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.server_arguments = {"--map-folder", processes.folder().string()};
  pipeline.Start();
  ASSERT_TRUE(pipeline.WaitForFrames(4));
  const std::string map = (processes.folder() / "map.vismap").string();
  const auto save = [&](const std::string& name) {
    const auto tool = processes.Start("map", {"save", name});
    EXPECT_TRUE(tool->WaitForExit().has_value());
    return std::pair(*tool->WaitForExit(), tool->StandardError());
  };
  EXPECT_EQ(save("map").first, 0);
  const Result<std::vector<uint8_t>> before = ReadFileBytes(map);
  ASSERT_TRUE(before);
  pipeline.WaitForEnd();

  // No file of the server can grow beyond this size, as on a full disk.
  const rlimit limit{before->size() / 2, RLIM_INFINITY};
  ASSERT_EQ(prlimit(pipeline.server->pid(), RLIMIT_FSIZE, &limit, nullptr), 0);
  const auto [full_code, full_error] = save("map");
  EXPECT_EQ(full_code, 1);
  EXPECT_THAT(full_error, HasSubstr("map.vismap"));
  EXPECT_EQ(*ReadFileBytes(map), *before) << "the old file is not damaged";
  size_t leftovers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(processes.folder()))
    leftovers += entry.path().string().find(".tmp-") != std::string::npos ? 1 : 0;
  EXPECT_EQ(leftovers, 0u);

  const rlimit none{RLIM_INFINITY, RLIM_INFINITY};
  ASSERT_EQ(prlimit(pipeline.server->pid(), RLIMIT_FSIZE, &none, nullptr), 0);
  EXPECT_EQ(save("map").first, 0) << "the server still runs and can save again";
  EXPECT_NE(*ReadFileBytes(map), *before);
}

TEST(Faults, FramesOutOfOrderAndClockJumpsAreIntegratedOnceAndCounted) {
  ProcessBus processes;
  const auto server = processes.Start("map-server");
  const auto segmenter = processes.Start("depth-segmenter", {"--detections", "none"});
  ASSERT_TRUE(processes.WaitForReady({"map-server", "depth-segmenter"}));
  std::vector<int64_t> integrated, duplicates;
  std::optional<process_status_t> last;
  processes.bus().Subscribe<frame_commit_t>(kMapCommitChannel, [&](const frame_commit_t& commit) {
    (commit.status == frame_commit_t::STATUS_INTEGRATED ? integrated : duplicates)
        .push_back(commit.utime);
  });
  processes.bus().Subscribe<process_status_t>(kStatusChannel, [&](const process_status_t& status) {
    if (status.process == "map-server") last = status;
  });
  const auto room = OpenSequence("synthetic:room?frames=6&width=160", "");
  ASSERT_TRUE(room);
  // One hour ahead, back again, one frame late, and one frame twice.
  const std::vector<int64_t> utimes = {1'000'000, 1'033'000, 3'601'066'000,
                                       1'099'000, 1'066'000, 1'132'000};
  const auto publish = [&](size_t i) {
    Result<SensorFrame> frame = (*room)->Read(i);
    ASSERT_TRUE(frame);
    frame->header.utime = utimes[i];
    rgbd_frame_t message = Encode(*frame);
    message.after_utime = -1;
    processes.bus().Publish(kRgbdFrameChannel, message);
  };
  for (size_t i = 0; i < utimes.size(); ++i) publish(i);
  publish(2);
  ASSERT_TRUE(processes.SpinUntil([&] { return !duplicates.empty() && integrated.size() == 6; }));
  EXPECT_EQ(integrated, utimes) << "in the order of arrival";
  EXPECT_EQ(duplicates, std::vector<int64_t>{utimes[2]});
  EXPECT_TRUE(processes.SpinUntil([&] {
    return last && Counter(*last, "clock_jumps") == 2 && Counter(*last, "frames_out_of_order") == 2;
  }));
  EXPECT_EQ(Ask(&processes, "frames").revision, 6);
}

TEST(SeveralCameras, TwoReplaysOfOneCameraFailInsteadOfLosingHalfOfTheFramesInSilence) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.StartServer();
  pipeline.StartSegmenter();
  const auto replay = [&](const std::string& name) {
    return processes.Start("sensor-replay",
                           {"--dataset", RoomPipeline::kRoom, "--mode", "lockstep", "--name", name,
                            "--wait-for", "map-server,depth-segmenter"});
  };
  const auto first = replay("first"), second = replay("second");
  ASSERT_TRUE(processes.SpinUntil([&] { return !first->Running() && !second->Running(); }));
  const std::string said = first->StandardError() + second->StandardError();
  EXPECT_TRUE(first->WaitForExit() != 0 || second->WaitForExit() != 0) << said;
  EXPECT_THAT(said, HasSubstr("camera 0 is published by more than one process"));
  EXPECT_THAT(said, HasSubstr("--camera-id"));
}

TEST(SeveralCameras, TwoReplaysBuildOneMapWithAllFrames) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.Start();
  const auto second = processes.Start(
      "sensor-replay", {"--dataset", RoomPipeline::kRoom, "--mode", "lockstep", "--camera-id", "1",
                        "--name", "second-camera", "--wait-for", "map-server,depth-segmenter"});
  pipeline.WaitForEnd();
  ASSERT_TRUE(processes.SpinUntil([&] { return !second->Running(); }));
  EXPECT_EQ(second->WaitForExit(), 0) << second->StandardError();
  EXPECT_TRUE(pipeline.WaitForFrames(2 * RoomPipeline::kFrames));
  EXPECT_EQ(Ask(&processes, "frames").revision, 2 * RoomPipeline::kFrames);
  const auto info = processes.Start("map", {"info", "live"});
  EXPECT_EQ(info->WaitForExit(), 0) << info->StandardError();
  EXPECT_THAT(info->StandardOutput(), HasSubstr("32"));
}

}  // namespace
}  // namespace vismap
