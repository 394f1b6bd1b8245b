// What holds for the folders of all formats: options, text files, times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "sample_images.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(OpenDataset, StrideCountsRecordedFramesMaxFramesUsableOnes) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  EXPECT_EQ(OpenOrFail(folder / "seq", {.stride = 2})->Header(1).frame_number, 4);
  EXPECT_EQ(OpenOrFail(folder / "seq", {.max_frames = 2})->size(), 2u);
  folder.Write("seq/frame-000000.pose.txt", kLost);
  const auto dataset = OpenOrFail(folder / "seq", {.max_frames = 1});
  EXPECT_EQ(dataset->Header(0).frame_number, 2);
  EXPECT_EQ(dataset->skipped().size(), 1u);
}

TEST(OpenDataset, RefusesBadOptionsFoldersAndFormats) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  const std::string path = (folder / "seq").string();
  EXPECT_THAT(OpenDataset(path, "", {.stride = 0}).error().message, HasSubstr("stride is 0"));
  EXPECT_THAT(OpenDataset(path, "", {.max_frames = -1}).error().message, HasSubstr("max_frames"));
  EXPECT_THAT(OpenDataset(path, "kitti").error().message,
              AllOf(HasSubstr("\"kitti\""), HasSubstr("7scenes")));
  EXPECT_THAT(OpenDataset(path, "scenenn").error().message, HasSubstr("asus.ini"));
  EXPECT_TRUE(OpenDataset(path, "7scenes"));
  EXPECT_THAT(OpenDataset(path + "/nothing", "").error().message, HasSubstr("No such file"));
  EXPECT_THAT(OpenDataset(path + "/frame-000000.pose.txt", "").error().message,
              HasSubstr("expected a folder"));
  EXPECT_THAT(OpenDataset(folder.path().string(), "").error().message,
              HasSubstr("no known sequence"));
}

TEST(OpenDataset, NumbersThatAreTimesInNanosecondsAreAnErrorWithTheirText) {
  const TempFolder folder;
  WriteScanNet(folder);
  folder.Write("seq/depth/1305031236005000000.png", GreyPng(kWidth, kHeight, 1500));
  folder.Write("seq/color/1305031236005000000.jpg", ColorJpeg(2 * kWidth, 2 * kHeight));
  EXPECT_THAT(ErrorOf(folder / "seq"),
              AllOf(HasSubstr("1305031236005000000 is out of range"), HasSubstr("nanoseconds")));
}

TEST(OpenDataset, LargeTextFilesAreRefusedBeforeTheyAreRead) {
  const TempFolder folder;
  WritePlainTum(folder);
  std::filesystem::resize_file(folder / "seq_fr1/groundtruth.txt", uintmax_t{1} << 40);  // sparse
  EXPECT_THAT(ErrorOf(folder / "seq_fr1"),
              AllOf(HasSubstr("groundtruth.txt"), HasSubstr("expected at most 134217728 bytes")));
}

TEST(OpenDataset, TextFilesMayBeginWithAByteOrderMark) {
  for (const SampleSequence& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    const TempFolder folder;
    images.write(folder);
    namespace fs = std::filesystem;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
      const std::string extension = entry.path().extension().string();
      if (!entry.is_regular_file() || extension == ".png" || extension == ".jpg") continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(file), {}};
      for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
        text.replace(at, 1, "\r\n");
      std::ofstream(entry.path(), std::ios::binary) << "\xEF\xBB\xBF" << text;
    }
    EXPECT_EQ(CountFrames(folder / images.folder), std::pair(3, 3));
  }
}

TEST(OpenDataset, OnlySequencesWithTimesHaveAClock) {
  for (const SampleSequence& images : AllFormats()) {
    const TempFolder folder;
    images.write(folder);
    const std::string name = images.name;
    EXPECT_EQ(OpenOrFail(folder / images.folder)->has_clock(), name == "scenenn" || name == "tum")
        << name;
  }
}

}  // namespace
}  // namespace vismap
