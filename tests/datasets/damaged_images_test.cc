// One damaged or missing image must not cost the other frames, whatever the format.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "sample_images.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

void CutInHalf(const std::filesystem::path& path) {
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
}

TEST(OpenDataset, OneDamagedImageCostsOnlyItself) {
  for (const SampleSequence& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    const auto left_after = [&](const std::string& image, const auto& damage) {
      const TempFolder folder;
      images.write(folder);
      damage(folder / images.folder / image);
      return CountFrames(folder / images.folder);
    };
    const auto empty = [](const std::filesystem::path& path) {
      std::filesystem::resize_file(path, 0);
    };
    using Counts = std::pair<int, int>;
    EXPECT_EQ(left_after(images.color2, CutInHalf), Counts(3, 2));
    EXPECT_EQ(left_after(images.depth2, CutInHalf), Counts(2, 2));
    EXPECT_EQ(left_after(images.color3, CutInHalf), Counts(2, 2)) << "the last image is cut off";
    EXPECT_EQ(left_after(images.depth3, CutInHalf), Counts(2, 2));
    EXPECT_EQ(left_after(images.color3, empty), Counts(2, 2));
    EXPECT_EQ(left_after(images.depth3, empty), Counts(2, 2));
  }
}

TEST(OpenDataset, ADamagedFirstImageCostsOnlyItself) {
  for (const SampleSequence& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    for (const bool depth : {false, true}) {
      const TempFolder folder;
      images.write(folder);
      const std::filesystem::path second =
          folder / images.folder / (depth ? images.depth2 : images.color2);
      // The first frame's image is the first one of its kind by name.
      const std::string start = second.filename().string().substr(0, 1);
      std::set<std::filesystem::path> siblings;
      for (const auto& entry : std::filesystem::directory_iterator(second.parent_path())) {
        const std::string file = entry.path().filename().string();
        const bool same_kind =
            std::string(images.name) == "7scenes"
                ? file.find(depth ? ".depth." : ".color.") != std::string::npos
                : std::string(images.name) != "replica" || file.starts_with(start);
        if (same_kind) siblings.insert(entry.path());
      }
      CutInHalf(*siblings.begin());
      EXPECT_EQ(CountFrames(folder / images.folder), depth ? std::pair(2, 2) : std::pair(3, 2));
    }
  }
}

TEST(OpenDataset, BytesAfterTheEndOfAPngCostNothing) {
  for (const SampleSequence& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    const TempFolder folder;
    images.write(folder);
    for (const std::string& image : {images.color2, images.depth2, images.color3, images.depth3})
      std::ofstream(folder / images.folder / image, std::ios::app) << std::string(512, '\0');
    EXPECT_EQ(CountFrames(folder / images.folder), std::pair(3, 3));
  }
}

TEST(OpenDataset, ColourOf16BitsIsRead) {
  const TempFolder folder;
  WriteSceneNn(folder);
  folder.Write("seq/image/image00002.png", ColorPng(kWidth, kHeight, 16));
  EXPECT_EQ(CountFrames(folder / "seq"), std::pair(3, 3));
}

TEST(OpenDataset, AnImageWithoutPartnerAtTheEndCostsOnlyItself) {
  for (const SampleSequence& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    for (const std::string& image : {images.color3, images.depth3}) {
      const TempFolder folder;
      images.write(folder);
      std::filesystem::remove(folder / images.folder / image);
      EXPECT_EQ(CountFrames(folder / images.folder).second, 2) << image;
    }
  }
}

}  // namespace
}  // namespace vismap
