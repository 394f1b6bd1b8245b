#include "base/file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

namespace vismap {
namespace {

namespace fs = std::filesystem;

class FileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "vismap-file-XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  size_t FilesInFolder() const {
    return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }
  std::string Text(const fs::path& path) const {
    const auto bytes = ReadFileBytes(path);
    return bytes ? std::string(bytes->begin(), bytes->end()) : bytes.error().message;
  }
  fs::path folder_;
};

TEST_F(FileTest, WritesAndReplacesAndLeavesNothingElse) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(WriteFileAtomically(path, "first, longer"));
  ASSERT_TRUE(WriteFileAtomically(path, "second"));
  EXPECT_EQ(Text(path), "second");
  ASSERT_TRUE(WriteFileAtomically(path, ""));
  EXPECT_EQ(Text(path), "");
  EXPECT_EQ(FilesInFolder(), 1u);
}

TEST_F(FileTest, MissingFolderIsAnErrorThatNamesThePath) {
  const fs::path path = folder_ / "none" / "a.txt";
  const auto written = WriteFileAtomically(path, "x");
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find(path.string()), std::string::npos);
  EXPECT_NE(written.error().message.find("No such file"), std::string::npos);
}

TEST_F(FileTest, TargetThatIsAFolderFailsAndLeavesNoTemporaryFile) {
  fs::create_directory(folder_ / "target");
  fs::create_directory(folder_ / "target" / "inside");
  ASSERT_FALSE(WriteFileAtomically(folder_ / "target", "x"));
  EXPECT_EQ(FilesInFolder(), 1u);
}

// A file size limit stands in for a full disk.
TEST_F(FileTest, WriteThatFailsHalfwayKeepsTheOldFile) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(WriteFileAtomically(path, "old"));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto written = WriteFileAtomically(path, std::string(5000, 'x'));
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, old_handler);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("errno"), std::string::npos);
  EXPECT_EQ(Text(path), "old");
  EXPECT_EQ(FilesInFolder(), 1u);
}

TEST_F(FileTest, ReadingSaysWhy) {
  EXPECT_FALSE(ReadFileBytes(folder_ / "none"));
  EXPECT_FALSE(ReadFileBytes(folder_));
  ASSERT_TRUE(WriteFileAtomically(folder_ / "a", "12345"));
  EXPECT_TRUE(ReadFileBytes(folder_ / "a", 5));
  EXPECT_FALSE(ReadFileBytes(folder_ / "a", 4));
}

TEST_F(FileTest, ReplacingKeepsThePermissions) {
  const fs::path path = folder_ / "a.txt";
  ASSERT_TRUE(WriteFileAtomically(path, "first"));
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  ASSERT_TRUE(WriteFileAtomically(path, "second"));
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(FileTest, ASymbolicLinkIsReplacedAndNotFollowed) {
  const fs::path target = folder_ / "target", link = folder_ / "link";
  ASSERT_TRUE(WriteFileAtomically(target, "mine"));
  fs::create_symlink(target, link);
  ASSERT_TRUE(WriteFileAtomically(link, "new"));
  EXPECT_EQ(Text(target), "mine");
  EXPECT_EQ(Text(link), "new");
  EXPECT_FALSE(fs::is_symlink(link));
}

TEST_F(FileTest, APipeIsNoFileAndIsNotWaitedFor) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(Text(pipe), pipe.string() + ": expected a regular file");
}

TEST_F(FileTest, TemporariesOfDeadProcessesAreRemovedAndNoOthers) {
  const fs::path path = folder_ / "map.vismap";
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  const std::string dead = std::to_string(child), alive = std::to_string(::getppid());
  for (const std::string& name :
       {"map.vismap.tmp-" + dead + "-0", "map.vismap.tmp-" + alive + "-0",
        std::string("map.vismap.tmp-x-0"), std::string("map.vismap.tmp-"),
        "map.vismap.tmp-" + dead + "-0.vismap", "map.vismap.tmp-" + dead + "-0x",
        "other.vismap.tmp-" + dead + "-0", "other.tmp-" + dead + "-0", std::string("map.vismap")}) {
    ASSERT_TRUE(WriteFileAtomically(folder_ / name, "x"));
  }
  EXPECT_EQ(RemoveStaleTemporaries(path), 1);
  EXPECT_FALSE(fs::exists(folder_ / ("map.vismap.tmp-" + dead + "-0")));
  EXPECT_EQ(FilesInFolder(), 8u);
  EXPECT_EQ(RemoveStaleTemporariesIn(folder_, ".vismap"), 1);
  EXPECT_FALSE(fs::exists(folder_ / ("other.vismap.tmp-" + dead + "-0")));
  EXPECT_EQ(FilesInFolder(), 7u);
}

TEST_F(FileTest, TheOldFileStaysUnderOtherNames) {
  const fs::path path = folder_ / "map", previous = folder_ / "map.previous",
                 replaced = folder_ / "map.replaced";
  const std::vector<uint8_t> first = {'1'}, second = {'2'}, third = {'3'};
  ASSERT_TRUE(WriteFileAndKeepOld(path, first, {previous, replaced})) << "there is none to keep";
  EXPECT_EQ(FilesInFolder(), 1u);
  ASSERT_TRUE(WriteFileAndKeepOld(path, second, {previous, replaced}));
  EXPECT_EQ(Text(path) + Text(previous) + Text(replaced), "211");
  ASSERT_TRUE(WriteFileAndKeepOld(path, third, {previous}));
  EXPECT_EQ(Text(path) + Text(previous) + Text(replaced), "321");
  EXPECT_EQ(FilesInFolder(), 3u);
  fs::remove(previous);
  fs::create_hard_link(path, previous);  // as after a power cut between the two renames
  ASSERT_TRUE(WriteFileAndKeepOld(path, first, {previous}));
  EXPECT_EQ(Text(path) + Text(previous), "13");
  EXPECT_EQ(FilesInFolder(), 3u);
}

TEST_F(FileTest, WhatCannotBeKeptIsNotReplaced) {
  const fs::path path = folder_ / "map";
  ASSERT_TRUE(WriteFileAtomically(path, "old"));
  fs::create_directory(folder_ / "map.previous");
  EXPECT_FALSE(WriteFileAndKeepOld(path, std::vector<uint8_t>{'x'}, {folder_ / "map.previous"}));
  EXPECT_EQ(Text(path), "old");
  EXPECT_EQ(FilesInFolder(), 2u);
}

TEST_F(FileTest, FilesSetAsideGetNamesOfTheirOwn) {
  const fs::path path = folder_ / "map";
  for (const char* text : {"a", "b", "c"}) {
    ASSERT_TRUE(WriteFileAtomically(path, text));
    ASSERT_TRUE(SetAside(path, "unusable"));
  }
  EXPECT_FALSE(fs::exists(path));
  EXPECT_EQ(Text(folder_ / "map.unusable-1") + Text(folder_ / "map.unusable-3"), "ac");
  EXPECT_FALSE(SetAside(path, "unusable")) << "there is no file";
}

}  // namespace
}  // namespace vismap
