#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vismap/frame_commit_t.hpp>
#include <vismap/map_reply_t.hpp>
#include <vismap/map_request_t.hpp>

#include "process/process_harness.h"

// Who follows a map ends with the server's state, whenever it came and whatever it missed; and what
// people do with a running server from the command line.

namespace vismap {
namespace {

constexpr char kRoom[] = "synthetic:room?frames=12&width=160";

struct Mapping {
  explicit Mapping(ProcessBus* processes) {
    server = processes->Start("map-server");
    segmenter = processes->Start("depth-segmenter", {"--detections", "none"});
    replay = processes->Start("sensor-replay", {"--dataset", kRoom, "--mode", "lockstep",
                                                "--wait-for", "map-server,depth-segmenter"});
    processes->bus().Subscribe<frame_commit_t>(kMapCommitChannel,
                                               [this](const frame_commit_t&) { ++commits; });
  }
  std::unique_ptr<ChildProcess> server, segmenter, replay;
  int commits = 0;
};

/// The answer to a request, asked again until somebody gives it.
map_reply_t Ask(ProcessBus* processes, const std::string& verb) {
  static int64_t next = 1000;
  auto answer = std::make_shared<std::optional<map_reply_t>>();
  const int64_t id = next++;
  processes->bus().Subscribe<map_reply_t>(kMapReplyChannel, [answer, id](const map_reply_t& reply) {
    if (reply.request_id == id) *answer = reply;
  });
  map_request_t request{};
  request.request_id = id;
  request.verb = verb;
  int rounds = 0;
  EXPECT_TRUE(processes->SpinUntil([&] {
    if (!answer->has_value() && rounds++ % 50 == 0)
      processes->bus().Publish(kMapRequestChannel, request);
    return answer->has_value();
  })) << verb;
  return answer->value_or(map_reply_t{});
}

void ExpectSameOccupancy(ProcessBus* processes) {
  const map_reply_t statistics = Ask(processes, "statistics");
  const auto json = nlohmann::json::parse(statistics.payload.begin(), statistics.payload.end());
  std::string digest;
  EXPECT_TRUE(processes->SpinUntil([&] {
    const map_reply_t reply = Ask(processes, "octomap-digest");
    digest = reply.message;
    return reply.ok && reply.revision == statistics.revision;
  }));
  EXPECT_EQ(digest, json.at("occupancy_digest").get<std::string>());
}

TEST(OctomapExporter, ThatStartsLateAndIsKilledEndsWithTheServersState) {
  ProcessBus processes;
  Mapping mapping(&processes);
  ASSERT_TRUE(processes.SpinUntil([&] { return mapping.commits >= 3; }));
  const std::vector<std::string> arguments{"--out", processes.folder().string()};
  auto exporter = processes.Start("octomap-exporter", arguments);
  ASSERT_TRUE(processes.SpinUntil([&] { return mapping.commits >= 7; }));
  exporter->Signal(SIGKILL);
  exporter->WaitForExit();
  exporter = processes.Start("octomap-exporter", arguments);
  ASSERT_TRUE(processes.SpinUntil([&] { return !mapping.replay->Running(); }));
  EXPECT_EQ(mapping.replay->WaitForExit(), 0) << mapping.replay->StandardError();
  ExpectSameOccupancy(&processes);
  exporter->Signal(SIGTERM);
  EXPECT_EQ(exporter->WaitForExit(), 0) << exporter->StandardError();
  for (const char* name : {"octree.bt", "octree.closed.bt"}) {
    EXPECT_GT(std::filesystem::file_size(processes.folder() / name), 1000u) << name;
  }
}

TEST(MapServer, SavesLoadsAndResetsOnRequest) {
  ProcessBus processes;
  Mapping mapping(&processes);
  ASSERT_TRUE(processes.SpinUntil([&] { return !mapping.replay->Running(); }));
  const auto tool = [&](std::vector<std::string> arguments) {
    const auto child = processes.Start("map", arguments);
    EXPECT_EQ(child->WaitForExit(), 0) << child->StandardError();
    return child->StandardOutput();
  };
  const std::string a = (processes.folder() / "a.vismap").string(),
                    b = (processes.folder() / "b.vismap").string();
  const std::string hash = tool({"hash", "live"});
  EXPECT_THAT(tool({"save", a}), testing::HasSubstr(a));
  EXPECT_EQ(tool({"hash", a}), hash);
  tool({"reset"});
  EXPECT_NE(tool({"hash", "live"}), hash);
  tool({"load", a});
  EXPECT_EQ(tool({"hash", "live"}), hash);
  tool({"save", b});
  EXPECT_THAT(tool({"diff", a, b}), testing::HasSubstr("equal"));
  EXPECT_THAT(tool({"objects", "live"}), testing::HasSubstr("discovered segments"));

  const auto refused =
      processes.Start("map", {"load", (processes.folder() / "missing.vismap").string()});
  EXPECT_EQ(refused->WaitForExit(), 1);
  EXPECT_THAT(refused->StandardError(), testing::HasSubstr("missing.vismap"));
  const auto unreadable =
      processes.Start("map", {"info", (processes.folder() / "missing.vismap").string()});
  EXPECT_EQ(unreadable->WaitForExit(), 3);
}

TEST(MapServer, SavesWhenStoppedAndGoesOnFromThere) {
  ProcessBus processes;
  const std::string map = (processes.folder() / "kept.vismap").string();
  const std::string config = (processes.folder() / "server.txtpb").string();
  std::ofstream(config) << "map_server { save_on_exit: \"" << map << "\" }";
  const auto server = processes.Start("map-server", {"--config", config});
  ASSERT_TRUE(processes.WaitForReady({"map-server"}));
  server->Signal(SIGTERM);
  EXPECT_EQ(server->WaitForExit(), 0) << server->StandardError();
  EXPECT_TRUE(std::filesystem::exists(map));

  std::ofstream(config) << "map_server { load: \"" << map << "\" }";
  const auto again = processes.Start("map-server", {"--config", config});
  ASSERT_TRUE(processes.SpinUntil(
      [&] { return again->StandardError().find("loaded") != std::string::npos; }));
  std::ofstream(map) << "no map";
  const auto broken = processes.Start("map-server", {"--config", config, "--name", "second"});
  EXPECT_EQ(broken->WaitForExit(), 3);
  EXPECT_THAT(broken->StandardError(), testing::HasSubstr("kept.vismap"));
}

}  // namespace
}  // namespace vismap
