#include "process/room_pipeline.h"

#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_request_t.hpp>

namespace vismap {

void RoomPipeline::Start() {
  processes_->bus().Subscribe<frame_commit_t>(
      kMapCommitChannel, [this](const frame_commit_t& commit) {
        if (commit.status == frame_commit_t::STATUS_INTEGRATED) ++integrated_;
      });
  StartServer();
  StartSegmenter();
  if (detections != "none") StartDetector();
  StartExporter();
  replay = processes_->Start(
      "sensor-replay",
      {"--dataset", dataset, "--mode", "lockstep", "--window", "4", "--resend-s",
       std::to_string(resend), "--wait-for",
       std::string("map-server,depth-segmenter") + (detections == "none" ? "" : ",detector")});
}

void RoomPipeline::StartServer() { server = map_processes_->Start("map-server", server_arguments); }
void RoomPipeline::StartSegmenter() {
  std::vector<std::string> arguments{"--detections", detections};
  arguments.insert(arguments.end(), segmenter_arguments.begin(), segmenter_arguments.end());
  segmenter = processes_->Start("depth-segmenter", arguments);
}
void RoomPipeline::StartDetector() { detector = processes_->Start("detector", detector_arguments); }
void RoomPipeline::StartExporter() {
  exporter = map_processes_->Start("octomap-exporter", exporter_arguments);
}

bool RoomPipeline::WaitForFrames(int count) {
  return processes_->SpinUntil([&] { return integrated_ >= count; });
}

void RoomPipeline::WaitForEnd() {
  EXPECT_TRUE(processes_->SpinUntil([&] { return !replay->Running(); }));
  EXPECT_EQ(replay->WaitForExit(), 0) << replay->StandardError();
}

void Crash(ChildProcess* process) {
  process->Signal(SIGKILL);
  process->WaitForExit();
}

map_reply_t Ask(ProcessBus* processes, const std::string& verb, const std::string& argument) {
  static int64_t next = 1000;
  const int64_t id = next++;
  auto answer = std::make_shared<std::optional<map_reply_t>>();
  processes->bus().Subscribe<map_reply_t>(kMapReplyChannel, [answer, id](const map_reply_t& reply) {
    if (reply.request_id == id) *answer = reply;
  });
  map_request_t request{};
  request.request_id = id;
  request.verb = verb;
  request.argument = argument;
  int rounds = 0;
  EXPECT_TRUE(processes->SpinUntil([&] {
    if (!answer->has_value() && rounds++ % 50 == 0)
      processes->bus().Publish(kMapRequestChannel, request);
    return answer->has_value();
  })) << verb;
  return answer->value_or(map_reply_t{});
}

std::string ServerStatistic(ProcessBus* processes, const std::string& name) {
  const map_reply_t reply = Ask(processes, "statistics");
  EXPECT_TRUE(reply.ok) << reply.message;
  const auto json =
      nlohmann::json::parse(reply.payload.begin(), reply.payload.end(), nullptr, false);
  return json.is_object() ? json.value(name, "none") : "none";
}

void ExpectExporterIsLevel(ProcessBus* processes) {
  const std::string expected = ServerStatistic(processes, "occupancy_digest");
  const int64_t revision = Ask(processes, "statistics").revision;
  std::string digest;
  EXPECT_TRUE(processes->SpinUntil([&] {
    const map_reply_t reply = Ask(processes, "octomap-digest");
    digest = reply.message;
    return reply.ok && reply.revision == revision;
  }));
  EXPECT_EQ(digest, expected);
}

std::string OfflineRoomHash(const std::string& threads, const std::string& dataset,
                            const std::vector<std::string>& more) {
  const TempFolder folder;
  std::vector<std::string> arguments = {"--dataset", dataset, "--threads",
                                        threads,     "--out", (folder / "out").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  ChildProcess offline("offline-mapper", arguments, folder.path());
  EXPECT_EQ(offline.WaitForExit(), 0) << offline.StandardError();
  std::ifstream report(folder / "out" / "report.json");
  const auto json = nlohmann::json::parse(report, nullptr, false);
  return json.is_object() ? json["map"].value("hash", "none") : "none";
}

}  // namespace vismap
