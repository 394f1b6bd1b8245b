#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "process/room_pipeline.h"

// A process that follows the map reaches the state of the server, also after a late start or missed
// updates. And the commands of vismap-map for a running server.

namespace vismap {
namespace {

TEST(OctomapExporter, HasTheStateOfTheServerAfterALateStartAndACrash) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.exporter_arguments = {"--out", processes.folder().string()};
  pipeline.Start();
  Crash(pipeline.exporter.get());
  ASSERT_TRUE(pipeline.WaitForFrames(3));
  pipeline.StartExporter();
  ASSERT_TRUE(pipeline.WaitForFrames(7));
  Crash(pipeline.exporter.get());
  pipeline.StartExporter();
  pipeline.WaitForEnd();
  ExpectExporterIsLevel(&processes);
  pipeline.exporter->Signal(SIGTERM);
  EXPECT_EQ(pipeline.exporter->WaitForExit(), 0) << pipeline.exporter->StandardError();
  for (const char* name : {"octree.bt", "octree.closed.bt"}) {
    EXPECT_GT(std::filesystem::file_size(processes.folder() / name), 1000u) << name;
  }
}

TEST(OctomapExporter, MakesItsFolderOrSaysAtOnceThatItCannot) {
  ProcessBus processes;
  const std::filesystem::path folder = processes.folder() / "new" / "trees";
  const auto exporter = processes.Start("octomap-exporter", {"--out", folder.string()});
  ASSERT_TRUE(processes.WaitForReady({"octomap-exporter"}));
  EXPECT_TRUE(std::filesystem::is_directory(folder));
  std::ofstream(processes.folder() / "file") << "no folder";
  const std::string impossible = (processes.folder() / "file" / "trees").string();
  const auto refused =
      processes.Start("octomap-exporter", {"--out", impossible, "--name", "second"});
  EXPECT_EQ(refused->WaitForExit(), 2);
  EXPECT_THAT(refused->StandardError(), ::testing::HasSubstr(impossible));
}

TEST(MapTool, WritesTheOctreeOfARunningMapAndOfASavedOneAlike) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.Start();
  pipeline.WaitForEnd();
  ExpectExporterIsLevel(&processes);
  const auto tree = [&](std::vector<std::string> arguments) {
    const std::string file = (processes.folder() / "tree.bt").string();
    arguments.insert(arguments.begin(), "octree");
    arguments.insert(arguments.end(), {"--out", file, "--res", "0.08", "--region", "1,1,0,2,2,1"});
    const auto child = processes.Start("map", arguments);
    EXPECT_EQ(child->WaitForExit(), 0) << child->StandardError();
    EXPECT_THAT(child->StandardOutput(), ::testing::HasSubstr("closed, leaves of 0.08 m"));
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  const std::string saved = (processes.folder() / "saved.vismap").string();
  EXPECT_EQ(processes.Start("map", {"save", saved})->WaitForExit(), 0);
  const std::string live = tree({"live"});
  EXPECT_THAT(live, ::testing::HasSubstr("# Octomap OcTree binary file"));
  EXPECT_EQ(tree({"live", "--from-exporter"}), live);
  EXPECT_EQ(tree({saved}), live);
  const std::string out = (processes.folder() / "no.bt").string();
  for (const auto& wrong : std::vector<std::vector<std::string>>{{"--res", "nan"},
                                                                 {"--res", "0.033"},
                                                                 {"--unknown", "7"},
                                                                 {"--inflate", "-1"},
                                                                 {"--region", "1,1,1,0,0,0"},
                                                                 {"--region", "nan,0,0,1,1,1"},
                                                                 {"--policy", "closed"}}) {
    std::vector<std::string> arguments{"octree", saved, "--out", out};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    const auto refused = processes.Start("map", arguments);
    EXPECT_EQ(refused->WaitForExit(), 2) << wrong[0] << " " << wrong[1];
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST(MapServer, SavesLoadsAndResetsOnRequest) {
  ProcessBus processes;
  RoomPipeline pipeline(&processes);
  pipeline.detections = "none";
  pipeline.server_arguments = {"--map-folder", processes.folder().string()};
  pipeline.Start();
  pipeline.WaitForEnd();
  const auto tool = [&](std::vector<std::string> arguments) {
    const auto child = processes.Start("map", arguments);
    EXPECT_EQ(child->WaitForExit(), 0) << child->StandardError();
    return child->StandardOutput();
  };
  const std::string a = (processes.folder() / "a.vismap").string(),
                    b = (processes.folder() / "b.vismap").string();
  const std::string hash = tool({"hash", "live"});
  EXPECT_THAT(tool({"save", "a"}), ::testing::HasSubstr(a));
  EXPECT_EQ(tool({"hash", a}), hash);
  tool({"reset"});
  EXPECT_NE(tool({"hash", "live"}), hash);
  tool({"load", "a"});
  EXPECT_EQ(tool({"hash", "live"}), hash);
  tool({"save", "b"});
  EXPECT_THAT(tool({"diff", a, b}), ::testing::HasSubstr("equal"));
  EXPECT_THAT(tool({"objects", "live"}), ::testing::HasSubstr("discovered segments"));

  const TempFolder here;
  const std::string fetched = (here / "c.vismap").string();
  EXPECT_THAT(tool({"save", fetched}), ::testing::HasSubstr("to " + fetched + ", map hash"));
  EXPECT_EQ(tool({"hash", fetched}), hash);
  const auto nowhere = processes.Start("map", {"save", (here / "no" / "c.vismap").string()});
  EXPECT_EQ(nowhere->WaitForExit(), 1);
  EXPECT_THAT(nowhere->StandardError(), ::testing::HasSubstr((here / "no").string()));

  const auto refused = processes.Start("map", {"load", "missing"});
  EXPECT_EQ(refused->WaitForExit(), 1);
  EXPECT_THAT(refused->StandardError(), ::testing::HasSubstr("missing.vismap"));
  const auto path = processes.Start("map", {"load", a});
  EXPECT_EQ(path->WaitForExit(), 2);
  EXPECT_THAT(path->StandardError(),
              ::testing::HasSubstr("start it with --map-folder " + processes.folder().string() +
                                   ", then: vismap-map load a"));
  const auto unreadable =
      processes.Start("map", {"info", (processes.folder() / "missing.vismap").string()});
  EXPECT_EQ(unreadable->WaitForExit(), 3);
}

TEST(MapServer, SavesWhenStoppedAndContinuesTheSavedMap) {
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
  EXPECT_THAT(broken->StandardError(), ::testing::HasSubstr("kept.vismap"));
}

}  // namespace
}  // namespace vismap
