#include "exports/outputs.h"

#include <gtest/gtest.h>

#include "exports/ply.h"
#include "support/analytic_room.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

TEST(WriteObjectMeshes, RemovesMeshesOfAnEarlierRunAndNothingThatItDidNotWrite) {
  const TempFolder folder;
  const PlyInfo with_classes{"map", {{ClassId{1}, "person"}, {ClassId{62}, "chair"}}};
  for (const std::string name : {"instance_3_chair.ply", "instance_7.ply", "segment_12.ply"})
    ASSERT_TRUE(WritePly(folder / name, Mesh{}, with_classes));
  ASSERT_TRUE(WritePly(folder / "segment_copy.ply", Mesh{}, {}));
  folder.Write("segment_notes.ply", "mine");
  folder.Write("segment_13.ply", "mine");
  folder.Write("segment_14.ply", "ply\nformat ascii 1.0\nelement vertex 0\nend_header\n");
  folder.Write("instance_8.ply", "");
  folder.Write("instance_3_chair.ply.bak", "mine");
  fs::create_directory(folder / "segment_15.ply");
  fs::create_symlink("elsewhere", folder / "segment_16.ply");

  ASSERT_TRUE(WriteObjectMeshes({}, {}, folder.path()));
  for (const std::string name : {"instance_3_chair.ply", "instance_7.ply", "segment_12.ply"})
    EXPECT_FALSE(fs::exists(folder / name)) << name;
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 8);
}

const char* const kFiles[] = {"map.vismap", "mesh.ply",         "objects.json",
                              "octree.bt",  "octree.closed.bt", "map.png"};

Result<std::string> WriteRoom(const TempFolder& folder, const OutputOptions& options = {}) {
  const SemanticMap map = testing_support::AnalyticRoom();
  return WriteOutputs(map, {}, MakeProducts(map, {}, options), options, folder.path());
}

TEST(WriteOutputs, WritesAllFiles) {
  const TempFolder folder;
  EXPECT_EQ(WriteRoom(folder), "");
  for (const char* name : kFiles) EXPECT_GT(fs::file_size(folder / name), 50u) << name;
}

TEST(WriteOutputs, WhatCannotBeMadeCostsOnlyItselfAndLeavesNoOlderFile) {
  const TempFolder folder;
  for (const char* name : kFiles) folder.Write(name, "old");
  OutputOptions options;
  options.octree.free_fraction = 2;
  const Result<std::string> written = WriteRoom(folder, options);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("free_fraction"), std::string::npos);
  for (const std::string name : kFiles) {
    const bool octree = name.starts_with("octree");
    EXPECT_EQ(fs::exists(folder / name), !octree) << name;
    EXPECT_TRUE(octree || fs::file_size(folder / name) > 50) << name;
  }
}

TEST(WriteOutputs, AMapInWhichNothingIsKnownHasNoOctree) {
  const TempFolder folder;
  for (const char* name : kFiles) folder.Write(name, "old");
  const SemanticMap map(testing_support::kGrid);
  const auto written = WriteOutputs(map, {}, MakeProducts(map, {}, {}), {}, folder.path());
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_NE(written->find("no octree of the map in " + folder.path().string()), std::string::npos);
  for (const std::string name : kFiles) {
    EXPECT_EQ(fs::exists(folder / name), !name.starts_with("octree")) << name;
    EXPECT_TRUE(!fs::exists(folder / name) || fs::file_size(folder / name) > 3) << name;
  }
}

TEST(WriteOutputs, WhatCannotBeWrittenCostsOnlyItself) {
  const TempFolder folder;
  fs::create_directories(folder / "mesh.ply");
  folder.Write("mesh.ply/mine", "mine");
  const Result<std::string> written = WriteRoom(folder);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("mesh.ply"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder / "mesh.ply/mine"));
  for (const char* name :
       {"map.vismap", "objects.json", "octree.bt", "octree.closed.bt", "map.png"})
    EXPECT_TRUE(fs::exists(folder / name)) << name;
}

TEST(WriteOutputs, AnOlderMapThatCannotBeReplacedStaysWithAllItsFiles) {
  const TempFolder folder;
  for (const char* name : kFiles) folder.Write(name, "old");
  fs::remove(folder / "map.vismap");
  folder.Write("map.vismap/old", "old");  // a folder, which no file replaces
  ASSERT_FALSE(WriteRoom(folder));
  for (const std::string name : kFiles) {
    EXPECT_TRUE(name == "map.vismap" || fs::file_size(folder / name) == 3) << name;
  }
}

}  // namespace
}  // namespace vismap
