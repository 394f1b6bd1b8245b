#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "process/room_pipeline.h"

// The commands of vismap-map that select objects, or leave them out.

namespace vismap {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;
namespace fs = std::filesystem;

/// A room from which the chair with id 8 is removed after the first of two tours.
constexpr char kChangingRoom[] = "synthetic:room?frames=24&width=240&tours=2&remove=8@25";
constexpr char kCoarseMap[] = "grid { voxel_size_m: 0.02 }\n";

/// Mapped once for all tests below.
class MappedRoom {
 public:
  static const MappedRoom& Get() {
    static const MappedRoom room;
    return room;
  }
  std::string map() const { return (folder_ / "out/map.vismap").string(); }
  fs::path folder() const { return folder_.path(); }
  Json objects() const { return Json::parse(std::ifstream(folder_ / "out/objects.json")); }

 private:
  MappedRoom() {
    folder_.Write("coarse.txtpb", kCoarseMap);
    ChildProcess mapper("offline-mapper",
                        {"--dataset", kChangingRoom, "--config",
                         (folder_ / "coarse.txtpb").string(), "--out", (folder_ / "out").string()},
                        folder_.path());
    EXPECT_EQ(mapper.WaitForExit(), 0) << mapper.StandardError();
  }
  TempFolder folder_;
};

struct Ran {
  int exit_code = -1;
  std::string out, error;
};

Ran MapTool(const std::vector<std::string>& arguments) {
  const TempFolder folder;
  ChildProcess tool("map", arguments, folder.path());
  Ran ran;
  ran.exit_code = tool.WaitForExit().value_or(-1);
  ran.out = tool.StandardOutput();
  ran.error = tool.StandardError();
  return ran;
}

Json Objects(std::vector<std::string> filters) {
  filters.insert(filters.begin(), {"objects", MappedRoom::Get().map(), "--json"});
  const Ran ran = MapTool(filters);
  EXPECT_EQ(ran.exit_code, 0) << ran.error;
  return Json::parse(ran.out, nullptr, false);
}

TEST(ObjectsCommand, SelectsByIdClassAndRegion) {
  const Json all = Objects({});
  EXPECT_EQ(all, MappedRoom::Get().objects());
  const Json first = all.at("objects").at(0);
  const Json one = Objects({"--id", std::to_string(first.at("instance").get<int>())});
  ASSERT_EQ(one.at("objects").size(), 1u);
  EXPECT_EQ(one["objects"][0], first);
  EXPECT_TRUE(one.at("discovered").empty());
  for (const char* key : {"class_probabilities", "score", "points", "area", "center", "size",
                          "orientation", "frames", "first_utime", "last_utime", "state"})
    EXPECT_TRUE(first.contains(key)) << key;

  const Json chairs = Objects({"--class", "chair"});
  EXPECT_GE(chairs.at("objects").size(), 1u);
  for (const Json& chair : chairs["objects"]) EXPECT_EQ(chair.at("class_name"), "chair");

  const Json near_tv = Objects({"--region", "-0.5,1.5,0.6,0.5,2.2,1.2"});
  EXPECT_LT(near_tv.at("objects").size(), all["objects"].size());
  EXPECT_THAT(near_tv.dump(), HasSubstr("\"tv\""));
  EXPECT_TRUE(near_tv.at("removed").empty());
}

TEST(ObjectsCommand, ShowsRemovedObjects) {
  const Json removed = Objects({}).at("removed");
  ASSERT_GE(removed.size(), 1u);
  EXPECT_EQ(removed[0].at("class_name"), "chair");
  EXPECT_EQ(removed[0].at("state"), "removed");
  EXPECT_GT(removed[0].at("removed_utime"), removed[0].at("last_utime"));
  EXPECT_FALSE(removed[0].contains("center"));
  const Ran table = MapTool({"objects", MappedRoom::Get().map()});
  EXPECT_EQ(table.exit_code, 0) << table.error;
  EXPECT_THAT(table.out, HasSubstr("removed: last seen at "));
}

TEST(ObjectsCommand, ReportsErrors) {
  const std::string map = MappedRoom::Get().map();
  const Ran id = MapTool({"objects", map, "--id", "999"});
  EXPECT_EQ(id.exit_code, 1);
  EXPECT_THAT(id.error, HasSubstr("no object with id 999; its instances are 1, "));
  const Ran word = MapTool({"objects", map, "--id", "first"});
  EXPECT_EQ(word.exit_code, 2);
  EXPECT_THAT(word.error, HasSubstr("'first' is not the id of an object"));
  const Ran name = MapTool({"objects", map, "--class", "chairs"});
  EXPECT_EQ(name.exit_code, 2);
  EXPECT_THAT(name.error, HasSubstr("'chairs' is neither a COCO class"));
  const Ran region = MapTool({"objects", map, "--region", "1,2,3"});
  EXPECT_EQ(region.exit_code, 2);
  EXPECT_THAT(region.error, HasSubstr("'1,2,3' is not a region"));
  EXPECT_EQ(Objects({"--class", "zebra"}).at("objects").size(), 0u);
}

std::string BytesOf(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

TEST(ExportCommand, WritesMeshAndPointsOfTheSelectedObjects) {
  const MappedRoom& room = MappedRoom::Get();
  const fs::path out = room.folder() / "one";
  const Json chair = Objects({"--class", "chair"}).at("objects").at(0);
  const std::string id = std::to_string(chair.at("instance").get<int>());
  const Ran ran = MapTool({"export", room.map(), "--object", id, "--out", out.string()});
  ASSERT_EQ(ran.exit_code, 0) << ran.error;
  EXPECT_THAT(ran.out, HasSubstr((out / ("instance_" + id + "_chair.ply")).string()));
  std::ifstream points(out / ("instance_" + id + "_chair.xyz"));
  int lines = 0;
  for (std::string line; std::getline(points, line);) ++lines;
  EXPECT_NEAR(lines, chair.at("points").get<int>(), 0.2 * lines);
  EXPECT_FALSE(fs::exists(out / "map.vismap"));

  const fs::path chairs = room.folder() / "chairs";
  EXPECT_EQ(MapTool({"export", room.map(), "--class", "chair", "--out", chairs.string()}).exit_code,
            0);
  for (const auto& file : fs::directory_iterator(chairs))
    EXPECT_THAT(file.path().filename().string(), HasSubstr("_chair."));
  const Ran none = MapTool({"export", room.map(), "--class", "zebra", "--out", out.string()});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.error, HasSubstr("none of the selected objects"));
}

TEST(ExportCommand, WritesOneThingAlone) {
  const MappedRoom& room = MappedRoom::Get();
  for (const auto& [what, file] :
       std::map<std::string, std::string>{{"mesh", "mesh.ply"},
                                          {"objects", "objects.json"},
                                          {"octree", "octree.bt"},
                                          {"octree-closed", "octree.closed.bt"}}) {
    const fs::path out = room.folder() / ("only_" + what);
    const Ran ran = MapTool({"export", room.map(), "--out", out.string(), "--only", what});
    ASSERT_EQ(ran.exit_code, 0) << ran.error;
    EXPECT_EQ(BytesOf(out / file), BytesOf(room.folder() / "out" / file)) << what;
    EXPECT_EQ(std::distance(fs::directory_iterator(out), {}), 1) << what;
  }
  const Ran both =
      MapTool({"export", room.map(), "--out", "x", "--only", "mesh", "--class", "chair"});
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.error, HasSubstr("exclude each other"));
}

TEST(SpaceCommands, LeaveObjectsOutOfASavedMap) {
  const MappedRoom& room = MappedRoom::Get();
  const Json chair = Objects({"--class", "chair"}).at("objects").at(0);
  const std::string without = "id=" + std::to_string(chair.at("instance").get<int>());
  const auto ask = [&](std::vector<std::string> arguments, bool leave_out) {
    arguments.insert(arguments.begin() + 1, room.map());
    if (leave_out) arguments.insert(arguments.end(), {"--without", without});
    const Ran ran = MapTool(arguments);
    EXPECT_EQ(ran.exit_code, 0) << ran.error;
    return ran.out;
  };
  const auto center = chair.at("center").get<std::vector<double>>();
  const std::string at =
      std::to_string(center[0]) + "," + std::to_string(center[1]) + "," + std::to_string(center[2]);
  const auto obstacle = [&](bool leave_out) {
    const Json json = Json::parse(ask({"clearance", "--at", at, "--json"}, leave_out));
    return json.at("points").at(0).at("obstacle_m").get<double>();
  };
  EXPECT_GT(obstacle(true), obstacle(false) + 0.1);
  EXPECT_NE(ask({"frontiers"}, true), ask({"frontiers"}, false));

  const auto free_cells = [&](bool leave_out) {
    const fs::path grid = room.folder() / (leave_out ? "without" : "with");
    ask({"export", "--grid", grid.string()}, leave_out);
    const std::string bytes = BytesOf(grid.string() + ".pgm");
    return std::count(bytes.begin(), bytes.end(), static_cast<char>(254));
  };
  EXPECT_GT(free_cells(true), free_cells(false));

  const fs::path tree = room.folder() / "tree.bt", out = room.folder() / "without_chair";
  ask({"octree", "--out", tree.string()}, true);
  ask({"export", "--out", out.string(), "--only", "octree-closed"}, true);
  EXPECT_EQ(BytesOf(out / "octree.closed.bt"), BytesOf(tree));
  EXPECT_NE(BytesOf(out / "octree.closed.bt"), BytesOf(room.folder() / "out/octree.closed.bt"));
}

TEST(SpaceCommands, RefuseObjectsThatCannotBeLeftOut) {
  const std::string map = MappedRoom::Get().map();
  const std::string out = (MappedRoom::Get().folder() / "refused").string();
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"clearance", map, "--at", "0,0,1", "--without", "id=999"},
           {"frontiers", map, "--without", "id=999"},
           {"export", map, "--grid", out, "--without", "id=999"}}) {
    const Ran ran = MapTool(arguments);
    EXPECT_EQ(ran.exit_code, 2) << arguments[0];
    EXPECT_THAT(ran.error, HasSubstr("no object with id 999")) << arguments[0];
  }
  const Ran all = MapTool({"export", map, "--out", out, "--without", "id=1"});
  EXPECT_EQ(all.exit_code, 2);
  EXPECT_THAT(all.error, HasSubstr("--only octree"));
  EXPECT_FALSE(fs::exists(out));
}

TEST(SpaceCommands, AMapInWhichNothingIsKnownHasNoOctree) {
  const TempFolder folder;
  folder.Write("out/octree.closed.bt", "of an earlier run");
  const fs::path out = folder / "out";
  ChildProcess mapper("offline-mapper",
                      {"--dataset", "synthetic:room?frames=1&width=160", "--out", out.string()},
                      folder.path());
  EXPECT_EQ(mapper.WaitForExit(), 0) << mapper.StandardError();
  EXPECT_THAT(mapper.StandardError(),
              HasSubstr("there is no octree of the map in " + out.string()));
  const Json report = Json::parse(std::ifstream(out / "report.json"));
  EXPECT_THAT(report.at("findings").dump(), HasSubstr("no octree of the map"));
  EXPECT_TRUE(fs::exists(out / "map.vismap"));
  for (const char* name : {"octree.bt", "octree.closed.bt"}) EXPECT_FALSE(fs::exists(out / name));
  const Ran ran = MapTool(
      {"export", (out / "map.vismap").string(), "--out", out.string(), "--only", "octree-closed"});
  EXPECT_EQ(ran.exit_code, 1);
  EXPECT_THAT(ran.error, HasSubstr("nothing in it is known to be free or occupied"));
}

TEST(ObjectsCommand, WorksWithARunningServerAndIdsSurviveALoad) {
  ProcessBus processes;
  const auto server = processes.Start(
      "map-server",
      {"--config", (MappedRoom::Get().folder() / "coarse.txtpb").string(), "--threads", "1",
       "--map-folder", std::filesystem::path(MappedRoom::Get().map()).parent_path().string()});
  ASSERT_TRUE(processes.WaitForReady({"map-server"}));
  ASSERT_EQ(MapTool({"load", "map", "--lcm-url", processes.url()}).exit_code, 0);
  const auto live = [&](std::vector<std::string> filters) {
    filters.insert(filters.begin(), {"objects", "live", "--json", "--lcm-url", processes.url()});
    return MapTool(filters);
  };
  for (const std::vector<std::string>& filters : std::vector<std::vector<std::string>>{
           {}, {"--class", "chair"}, {"--region", "0,0,0,1,1,1"}}) {
    const Ran ran = live(filters);
    ASSERT_EQ(ran.exit_code, 0) << ran.error;
    Json there = Json::parse(ran.out, nullptr, false), here = Objects(filters);
    there.erase("map_id");  // a loaded map gets a new id
    here.erase("map_id");
    EXPECT_EQ(there, here);
  }
  const fs::path here = MappedRoom::Get().folder() / "grid", there = here.string() + "_live";
  EXPECT_EQ(MapTool({"export", MappedRoom::Get().map(), "--grid", here.string()}).exit_code, 0);
  const Ran exported = MapTool({"export", "live", "--grid", there.string(), "--out", there.string(),
                                "--only", "mesh", "--lcm-url", processes.url()});
  ASSERT_EQ(exported.exit_code, 0) << exported.error;
  for (const char* ending : {".pgm", ".yaml"}) EXPECT_TRUE(fs::exists(there.string() + ending));
  EXPECT_EQ(fs::file_size(there.string() + ".pgm"), fs::file_size(here.string() + ".pgm"));
  EXPECT_TRUE(fs::exists(there / "mesh.ply"));
  const Ran unknown = live({"--id", "999"});
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.error, HasSubstr("no object with id 999"));
}

}  // namespace
}  // namespace vismap
