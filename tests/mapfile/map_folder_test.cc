#include "mapfile/map_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "base/file.h"
#include "mapfile/map_file.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

void SaveEmptyMap(const fs::path& path) {
  ASSERT_TRUE(SaveMap(SemanticMap(VoxelGridOptions{}), {}, path));
}

TEST(MapFolder, NamesBecomeFilesOfTheFolder) {
  const TempFolder folder;
  const MapFolder maps(folder.path());
  EXPECT_EQ(maps.ForSaving("kitchen").value(), folder / "kitchen.vismap");
  EXPECT_EQ(maps.ForSaving("kitchen-2.vismap").value(), folder / "kitchen-2.vismap");
  SaveEmptyMap(folder / "kitchen.vismap");
  EXPECT_TRUE(maps.ForSaving("kitchen"));  // a map may be replaced
  EXPECT_EQ(maps.ForLoading("kitchen").value(), folder / "kitchen.vismap");
  EXPECT_THAT(maps.ForLoading("garden").error().message, HasSubstr("no map of this name"));
}

TEST(MapFolder, PathsAreRefused) {
  const TempFolder folder;
  const MapFolder maps(folder.path());
  for (const std::string name : {"", "/etc/passwd", "../map", "a/b", "..", ".", ".profile", "a\\b",
                                 "a b", "a\nb", "\xc3\xa4", "~", "a;b"}) {
    EXPECT_THAT(maps.ForSaving(name).error().message, HasSubstr("no path")) << name;
    EXPECT_THAT(maps.ForLoading(name).error().message, HasSubstr("no path")) << name;
  }
  EXPECT_FALSE(maps.ForSaving(std::string(101, 'a')));
  EXPECT_FALSE(maps.ForSaving(std::string("a\0b", 3)));
}

TEST(MapFolder, OnlyMapsAreReplaced) {
  const TempFolder folder;
  const MapFolder maps(folder.path());
  folder.Write("notes.vismap", "not a map");
  folder.Write("empty.vismap", "");
  SaveEmptyMap(folder / "real.vismap");
  fs::create_symlink(folder / "real.vismap", folder / "link.vismap");
  fs::create_directory(folder / "folder.vismap");
  ASSERT_EQ(::mkfifo((folder / "pipe.vismap").c_str(), 0600), 0);
  for (const std::string name : {"notes", "empty", "link", "folder", "pipe"})
    EXPECT_THAT(maps.ForSaving(name).error().message, HasSubstr("not replaced")) << name;
  for (const std::string name : {"link", "folder", "pipe"})
    EXPECT_THAT(maps.ForLoading(name).error().message, HasSubstr("regular file")) << name;
}

TEST(MapFolder, WhatIsNoNameIsToldInPrintableText) {
  EXPECT_THAT(CheckMapName("a\n\x1b[2J").error().message, HasSubstr("'a\\n\\x1b[2J'"));
  EXPECT_LT(CheckMapName(std::string(60000, '/')).error().message.size(), 400u);
}

TEST(MapFolder, ThatIsFullTakesNoMoreMaps) {
  const TempFolder folder;
  SaveEmptyMap(folder / "kitchen.vismap");
  EXPECT_TRUE(MapFolder(folder.path(), 1 << 20).ForSaving("garden"));
  const MapFolder small(folder.path(), 10);
  EXPECT_THAT(small.ForSaving("garden").error().message, HasSubstr("is full"));
  EXPECT_THAT(small.ForSaving("kitchen").error().message, HasSubstr("is full"));
  EXPECT_TRUE(small.ForLoading("kitchen"));
  for (int i = 0; i < 1000; ++i) folder.Write(std::to_string(i), "");
  EXPECT_THAT(MapFolder(folder.path()).ForSaving("garden").error().message, HasSubstr("is full"));
  EXPECT_TRUE(MapFolder(folder.path()).ForSaving("kitchen")) << "it needs no further file";
}

TEST(MapFolder, NamesOfKeptAndTemporaryFilesCannotBeReached) {
  const TempFolder folder;
  const MapFolder maps(folder.path());
  for (const std::string name :
       {"kitchen.vismap.previous", "kitchen.vismap.replaced", "kitchen.vismap.tmp-12-3"}) {
    SaveEmptyMap(folder / name);
    EXPECT_EQ(maps.ForSaving(name).value(), folder / (name + ".vismap"));
    EXPECT_FALSE(maps.ForLoading(name));
  }
}

TEST(MapFile, StartTellsTheNumberOfFrames) {
  const TempFolder folder;
  SemanticMap map{VoxelGridOptions{}};
  map.revision = 17;
  ASSERT_TRUE(SaveMap(map, {}, folder / "a.vismap"));
  EXPECT_EQ(FramesOfMapFile(folder / "a.vismap").value(), 17);
  const auto bytes = ReadFileBytes(folder / "a.vismap").value();
  for (const size_t length : {0, 5, 27, 28, 40}) {
    folder.Write("cut.vismap", std::span(bytes).first(length));
    EXPECT_FALSE(FramesOfMapFile(folder / "cut.vismap")) << length;
  }
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_FALSE(FramesOfMapFile(folder / "pipe"));
  EXPECT_FALSE(FramesOfMapFile(folder / "missing"));
}

TEST(MapFolder, WithoutAFolderClientsMayDoNeither) {
  EXPECT_THAT(MapFolder("").ForSaving("a").error().message, HasSubstr("map_folder"));
  EXPECT_THAT(MapFolder("").ForLoading("a").error().message, HasSubstr("map_folder"));
}

}  // namespace
}  // namespace vismap
