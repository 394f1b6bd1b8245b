#include "datasets/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_images.h"
#include "support/mutations.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

TEST(ImageInfo, TellsKindSizeAndDepth) {
  const Result<ImageFileInfo> grey = ReadImageInfo(std::span<const uint8_t>(GreyPng(7, 5, 1)));
  ASSERT_TRUE(grey);
  EXPECT_EQ(grey->kind, ImageFileInfo::Kind::kPng);
  EXPECT_EQ(grey->width, 7);
  EXPECT_EQ(grey->height, 5);
  EXPECT_EQ(grey->bits, 16);
  EXPECT_TRUE(grey->grey);
  const Result<ImageFileInfo> jpeg = ReadImageInfo(std::span<const uint8_t>(ColorJpeg(9, 4)));
  ASSERT_TRUE(jpeg);
  EXPECT_EQ(jpeg->kind, ImageFileInfo::Kind::kJpeg);
  EXPECT_EQ(jpeg->width, 9);
}

TEST(ImageInfo, RefusesHugePngs) {
  std::vector<uint8_t> bytes = GreyPng(7, 5, 1);
  bytes[16] = 0x7f;
  EXPECT_THAT(ReadImageInfo(std::span<const uint8_t>(bytes)).error().message,
              HasSubstr("expected 1..16384"));
  bytes[16] = 0xff;
  EXPECT_FALSE(ReadImageInfo(std::span<const uint8_t>(bytes)));
}

TEST(ImageInfo, RefusesMorePixelsThanAreEverDecoded) {
  std::vector<uint8_t> bytes = GreyPng(7, 5, 1);
  const auto set_size = [&](uint8_t width, uint8_t height) {  // in units of 256 pixels
    bytes[18] = width;
    bytes[22] = height;
    bytes[19] = bytes[23] = 0;
  };
  set_size(0x40, 0x40);  // 16384 x 16384
  EXPECT_THAT(
      ReadImageInfo(std::span<const uint8_t>(bytes)).error().message,
      HasSubstr("16384x16384; expected 1..16384 pixels along each side and at most 33554432"));
  set_size(0x40, 0x08);  // 16384 x 2048
  EXPECT_TRUE(ReadImageInfo(std::span<const uint8_t>(bytes)));
}

TEST(ReadPng16, MutationsGiveAnImageOfTheRightSizeOrANamedError) {
  const TempFolder folder;
  ForEachMutation(GreyPng(16, 12, 1234), 1500, [&](const std::vector<uint8_t>& bytes) {
    folder.Write("x.png", bytes);
    const Result<Image<uint16_t>> image = ReadPng16(folder / "x.png", 16, 12);
    if (image) {
      EXPECT_EQ(image->size(), 16u * 12u);
    } else {
      EXPECT_THAT(image.error().message, HasSubstr("x.png"));
    }
  });
}

TEST(ReadColorAsJpeg, MutationsGiveAJpegOrANamedError) {
  const TempFolder folder;
  for (const std::vector<uint8_t>& good : {ColorPng(16, 12), ColorJpeg(16, 12)}) {
    ForEachMutation(good, 700, [&](const std::vector<uint8_t>& bytes) {
      folder.Write("x", bytes);
      const Result<std::vector<uint8_t>> jpeg = ReadColorAsJpeg(folder / "x", 16, 12);
      if (jpeg) {
        EXPECT_TRUE(ReadColor(folder / "x", 16, 12));
      } else {
        EXPECT_THAT(jpeg.error().message, HasSubstr("/x"));
      }
    });
  }
}

// For a camera of twice the resolution, each pixel has the colour of its own direction.
TEST(ResampleColor, TakesThePixelInTheSameDirection) {
  Image<Rgb8> large(8, 6);
  for (int v = 0; v < 6; ++v) {
    for (int u = 0; u < 8; ++u) {
      large(v, u) = {static_cast<uint8_t>(u), static_cast<uint8_t>(v), 0};
    }
  }
  const PinholeCamera from{8, 6, 20, 20, 4, 3}, to{4, 3, 10, 10, 2, 1.5};
  const Image<Rgb8> small = ResampleColor(large, from, to);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 4; ++u) EXPECT_EQ(small(v, u).r, 2 * u);
  }
  EXPECT_EQ(ResampleColor(large, from, {4, 3, 10, 10, 20, 1})(0, 0), Rgb8{}) << "out of sight";
}

}  // namespace
}  // namespace vismap
