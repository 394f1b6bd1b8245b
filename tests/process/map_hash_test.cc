#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "process/process_harness.h"

// The same frames give the same map: in one process, in many, with one thread, with two, and after
// crashes.

namespace vismap {
namespace {

constexpr char kRoom[] = "synthetic:room?frames=16&width=160";
constexpr int kFrames = 16;

/// What the pipeline is made of, all at their work.
struct Pipeline {
  explicit Pipeline(ProcessBus* processes, const std::string& threads = "2") {
    server = processes->Start("map-server", {"--threads", threads});
    segmenter = StartSegmenter(processes);
    detector = processes->Start("detector", {"--dataset", kRoom});
    replay = processes->Start(
        "sensor-replay", {"--dataset", kRoom, "--mode", "lockstep", "--window", "4", "--resend-s",
                          "0.5", "--wait-for", "map-server,depth-segmenter,detector"});
    processes->bus().Subscribe<frame_commit_t>(
        kMapCommitChannel, [this](const frame_commit_t& commit) {
          if (commit.status == frame_commit_t::STATUS_INTEGRATED) ++integrated;
        });
  }
  static std::unique_ptr<ChildProcess> StartSegmenter(ProcessBus* processes) {
    return processes->Start("depth-segmenter", {"--detections", "required"});
  }

  std::unique_ptr<ChildProcess> server, segmenter, detector, replay;
  int integrated = 0;
};

/// The map server's answer to a request; the test fails when it refuses.
nlohmann::json Ask(ProcessBus* processes, const std::string& verb) {
  static int64_t next = 1;
  const int64_t id = next++;
  nlohmann::json answer;
  bool answered = false;
  processes->bus().Subscribe<map_reply_t>(kMapReplyChannel, [&, id](const map_reply_t& reply) {
    if (reply.request_id != id || answered) return;
    EXPECT_TRUE(reply.ok) << reply.message;
    answer = nlohmann::json::parse(reply.payload.begin(), reply.payload.end(), nullptr, false);
    answered = true;
  });
  map_request_t request{};
  request.request_id = id;
  request.verb = verb;
  processes->bus().Publish(kMapRequestChannel, request);
  EXPECT_TRUE(processes->SpinUntil([&] { return answered; }));
  return answer;
}

/// Waits for the end of the replay; the hash of the map then.
std::string HashAtEnd(ProcessBus* processes, Pipeline* pipeline) {
  EXPECT_TRUE(processes->SpinUntil([&] { return !pipeline->replay->Running(); }));
  EXPECT_EQ(pipeline->replay->WaitForExit(), 0) << pipeline->replay->StandardError();
  const nlohmann::json statistics = Ask(processes, "statistics");
  EXPECT_EQ(pipeline->integrated, kFrames);
  return statistics.value("hash", "none");
}

std::string OfflineHash(const std::string& threads) {
  const TempFolder folder;
  ChildProcess offline(
      "offline-mapper",
      {"--dataset", kRoom, "--threads", threads, "--out", (folder / "out").string()},
      folder.path());
  EXPECT_EQ(offline.WaitForExit(), 0) << offline.StandardError();
  std::ifstream report(folder / "out" / "report.json");
  return nlohmann::json::parse(report)["map"]["hash"].get<std::string>();
}

TEST(MapHash, IsTheSameOfflineAndLiveWithOneThreadAndTwo) {
  const std::string offline = OfflineHash("1");
  EXPECT_EQ(OfflineHash("2"), offline);
  for (const char* threads : {"1", "2"}) {
    ProcessBus processes({"--socket-buffer-bytes", "16384"});
    Pipeline pipeline(&processes, threads);
    EXPECT_EQ(HashAtEnd(&processes, &pipeline), offline);
  }
}

TEST(MapHash, IsTheSameWhenSegmenterAndHubAreKilledOnTheWay) {
  const std::string offline = OfflineHash("2");
  ProcessBus processes;
  Pipeline pipeline(&processes);
  ASSERT_TRUE(processes.SpinUntil([&] { return pipeline.integrated >= 4; }));
  pipeline.segmenter->Signal(SIGKILL);
  pipeline.segmenter->WaitForExit();
  pipeline.segmenter = Pipeline::StartSegmenter(&processes);
  ASSERT_TRUE(processes.SpinUntil([&] { return pipeline.integrated >= 8; }));
  processes.RestartHub();
  EXPECT_TRUE(processes.SpinUntil([&] { return !pipeline.replay->Running(); }));
  EXPECT_EQ(pipeline.replay->WaitForExit(), 0) << pipeline.replay->StandardError();
  EXPECT_EQ(Ask(&processes, "statistics").value("hash", "none"), offline);
}

}  // namespace
}  // namespace vismap
