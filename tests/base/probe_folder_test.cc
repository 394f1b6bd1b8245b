#include "base/probe_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

TEST(ProbeFolder, CreatesAUsableFolderAndLeavesNothingInIt) {
  const TempFolder folder;
  ASSERT_TRUE(ProbeFolder(folder / "a/b", 1000));
  EXPECT_TRUE(fs::is_empty(folder / "a/b"));
}

TEST(ProbeFolder, WhatCannotBeAFolderIsToldAndNothingIsLeft) {
  const TempFolder folder;
  folder.Write("file", "x");
  EXPECT_THAT(ProbeFolder(folder / "file", 10).error().message, HasSubstr("file"));
  EXPECT_THAT(ProbeFolder(folder / "file/below", 10).error().message, HasSubstr("below"));
  EXPECT_FALSE(ProbeFolder("/proc/vismap", 10));
}

TEST(NewFolders, RemovesOnlyWhatWasNotThereAndIsEmpty) {
  const TempFolder folder;
  fs::create_directories(folder / "old");
  const NewFolders created(folder / "old/x/y");
  fs::create_directories(folder / "old/x/y");
  created.RemoveEmpty();
  EXPECT_TRUE(fs::is_empty(folder / "old"));
  fs::create_directories(folder / "old/x/y");
  folder.Write("old/x/mine", "x");
  created.RemoveEmpty();
  EXPECT_TRUE(fs::exists(folder / "old/x/mine"));
  EXPECT_FALSE(fs::exists(folder / "old/x/y"));
}

}  // namespace
}  // namespace vismap
