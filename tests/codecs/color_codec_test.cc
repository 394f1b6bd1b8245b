#include "codecs/color_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/mutations.h"

namespace vismap {
namespace {

using testing::HasSubstr;

Image<Rgb8> Gradient(int width, int height) {
  Image<Rgb8> image(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      image(v, u) = {static_cast<uint8_t>(u * 255 / width), static_cast<uint8_t>(v * 255 / height),
                     static_cast<uint8_t>(128)};
    }
  }
  return image;
}

TEST(Jpeg, KeepsSmoothColourWithinAFewSteps) {
  const Image<Rgb8> image = Gradient(97, 61);
  const Result<Image<Rgb8>> decoded = DecodeJpeg(EncodeJpeg(image), 97, 61);
  ASSERT_TRUE(decoded) << decoded.error().message;
  for (size_t i = 0; i < image.size(); ++i) {
    EXPECT_LE(std::abs(image.data()[i].r - decoded->data()[i].r), 8);
    EXPECT_LE(std::abs(image.data()[i].g - decoded->data()[i].g), 8);
    EXPECT_LE(std::abs(image.data()[i].b - decoded->data()[i].b), 8);
  }
}

TEST(Jpeg, SameImageGivesSameBytes) {
  EXPECT_EQ(EncodeJpeg(Gradient(64, 48)), EncodeJpeg(Gradient(64, 48)));
  EXPECT_NE(EncodeJpeg(Gradient(64, 48), 95), EncodeJpeg(Gradient(64, 48), 50));
}

TEST(Jpeg, HeaderTellsTheSize) {
  const Result<JpegSize> size = ReadJpegSize(EncodeJpeg(Gradient(33, 21)));
  ASSERT_TRUE(size);
  EXPECT_EQ(*size, (JpegSize{33, 21}));
}

TEST(Jpeg, RefusesOtherSizesBeforeDecoding) {
  const std::vector<uint8_t> bytes = EncodeJpeg(Gradient(33, 21));
  EXPECT_THAT(DecodeJpeg(bytes, 32, 21).error().message, HasSubstr("33x21; expected 32x21"));
  EXPECT_THAT(DecodeJpeg(bytes, 33, 22).error().message, HasSubstr("expected 33x22"));
  EXPECT_THAT(DecodeJpeg(bytes, 0, 0, 33 * 21 - 1).error().message, HasSubstr("at most 692"));
  EXPECT_TRUE(DecodeJpeg(bytes, 0, 0, 33 * 21));
}

TEST(Jpeg, RefusesAHugeSizeInTheHeader) {
  std::vector<uint8_t> bytes = EncodeJpeg(Gradient(16, 16));
  for (size_t i = 0; i + 9 < bytes.size(); ++i) {  // the frame header FF C0, then height and width
    if (bytes[i] == 0xff && bytes[i + 1] == 0xc0) {
      for (size_t k = 5; k < 9; ++k) bytes[i + k] = 0xfe;
    }
  }
  EXPECT_THAT(DecodeJpeg(bytes).error().message, HasSubstr("65278x65278"));
}

TEST(Jpeg, ATruncatedFileIsAnErrorNotAGreyRest) {
  std::vector<uint8_t> bytes = EncodeJpeg(Gradient(64, 48));
  for (const size_t size : {bytes.size() - 2, bytes.size() - 40, bytes.size() / 2, size_t{100}}) {
    EXPECT_FALSE(DecodeJpeg(std::span(bytes).first(size))) << size;
  }
}

TEST(Jpeg, GarbageIsAnError) {
  EXPECT_FALSE(DecodeJpeg({}));
  EXPECT_FALSE(DecodeJpeg(std::vector<uint8_t>(1000, 0x41)));
  EXPECT_FALSE(ReadJpegSize(std::vector<uint8_t>{0xff, 0xd8}));
}

TEST(Jpeg, MutationsGiveAValueOfTheRightSizeOrAnError) {
  ForEachMutation(EncodeJpeg(Gradient(48, 40)), 3000, [](const std::vector<uint8_t>& bytes) {
    const Result<Image<Rgb8>> image = DecodeJpeg(bytes, 48, 40);
    if (image) {
      EXPECT_EQ(image->size(), 48u * 40u);
    } else {
      EXPECT_THAT(image.error().message, HasSubstr("JPEG"));
    }
  });
}

}  // namespace
}  // namespace vismap
