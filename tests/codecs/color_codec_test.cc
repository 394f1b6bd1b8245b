#include "codecs/color_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <array>
#include <cstdlib>
#include <memory>

#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

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

// The bytes of a JPEG file with some more at an offset.
std::vector<uint8_t> WithBytes(std::vector<uint8_t> bytes, size_t at,
                               const std::vector<uint8_t>& more) {
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), more.begin(), more.end());
  return bytes;
}

TEST(Jpeg, StrayBytesCostNothing) {
  const std::vector<uint8_t> bytes = EncodeJpeg(Gradient(64, 48));
  const Image<Rgb8> image = *DecodeJpeg(bytes);
  const auto padded = DecodeJpeg(WithBytes(bytes, bytes.size(), std::vector<uint8_t>(512, 0)));
  ASSERT_TRUE(padded) << padded.error().message;
  EXPECT_EQ(*padded, image);
  const auto stray = DecodeJpeg(WithBytes(bytes, bytes.size() - 2, {0, 0, 0}));
  ASSERT_TRUE(stray) << stray.error().message;
  EXPECT_EQ(*stray, image);
}

TEST(Jpeg, DamagedDataIsDecodedAsFarAsItGoes) {
  std::vector<uint8_t> bytes = EncodeJpeg(Gradient(64, 48));
  const Image<Rgb8> image = *DecodeJpeg(bytes);
  bytes.erase(bytes.end() - 60, bytes.end() - 2);  // the end marker stays
  const auto decoded = DecodeJpeg(bytes);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ((*decoded)(0, 0), image(0, 0));
  EXPECT_NE(*decoded, image);
}

TEST(Jpeg, TheEndOfAPreviewIsNotThatOfTheFile) {
  const std::vector<uint8_t> bytes = EncodeJpeg(Gradient(64, 48));
  std::vector<uint8_t> preview{0xff, 0xe1, 0, 0};  // an application segment with a whole JPEG
  const std::vector<uint8_t> small = EncodeJpeg(Gradient(8, 8));
  preview.insert(preview.end(), small.begin(), small.end());
  preview[2] = static_cast<uint8_t>((preview.size() - 2) >> 8);
  preview[3] = static_cast<uint8_t>((preview.size() - 2) & 0xff);
  const std::vector<uint8_t> whole = WithBytes(bytes, 2, preview);
  EXPECT_TRUE(HasJpegEnd(whole));
  EXPECT_TRUE(DecodeJpeg(whole));
  EXPECT_FALSE(HasJpegEnd(std::span(whole).first(whole.size() - 40)));
}

// 16x16 of one colour, as a printer's program writes it: four inks, inverted.
std::vector<uint8_t> CmykJpeg(const std::array<uint8_t, 4>& inks) {
  const std::unique_ptr<void, int (*)(void*)> turbo(tjInitCompress(), tjDestroy);
  std::vector<uint8_t> pixels;
  for (int i = 0; i < 16 * 16; ++i) pixels.insert(pixels.end(), inks.begin(), inks.end());
  std::vector<uint8_t> bytes(tjBufSize(16, 16, TJSAMP_444) + 10000);
  unsigned char* target = bytes.data();
  unsigned long size = bytes.size();
  EXPECT_EQ(tjCompress2(turbo.get(), pixels.data(), 16, 0, 16, TJPF_CMYK, &target, &size,
                        TJSAMP_444, 95, TJFLAG_NOREALLOC),
            0);
  bytes.resize(size);
  return bytes;
}

TEST(Jpeg, InksBecomeColours) {
  const auto image = DecodeJpeg(CmykJpeg({255, 100, 30, 200}), 16, 16);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_NEAR((*image)(8, 8).r, 200, 3);
  EXPECT_NEAR((*image)(8, 8).g, 78, 3);
  EXPECT_NEAR((*image)(8, 8).b, 24, 3);
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
