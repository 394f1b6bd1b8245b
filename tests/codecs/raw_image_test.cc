#include "codecs/raw_image.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "codecs/color_codec.h"
#include "codecs/png_codec.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr int kColumns = 5, kRows = 3;

std::vector<uint8_t> Compressed(const std::vector<uint8_t>& bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<uint8_t> code(size);
  EXPECT_EQ(compress(code.data(), &size, bytes.data(), bytes.size()), Z_OK);
  code.resize(size);
  return code;
}

// 16-bit numbers 0, 1, ... + 256, little-endian.
std::vector<uint8_t> CountingBytes() {
  std::vector<uint8_t> bytes;
  for (int i = 0; i < kColumns * kRows; ++i) {
    bytes.push_back(static_cast<uint8_t>(i));
    bytes.push_back(1);
  }
  return bytes;
}

template <typename T>
std::string ErrorOf(const Result<T>& result) {
  return result ? "no error" : result.error().message;
}

TEST(DecodeRaw16, IsLittleEndianRowByRow) {
  const auto depth = DecodeRaw16(CountingBytes(), kColumns, kRows);
  ASSERT_TRUE(depth) << depth.error().message;
  EXPECT_EQ((*depth)(0, 0), 256);
  EXPECT_EQ((*depth)(2, 4), 256 + 14);
  EXPECT_THAT(ErrorOf(DecodeRaw16(CountingBytes(), kColumns, kRows + 1)),
              HasSubstr("expected 5x4 pixels of 2 bytes, 40 bytes in all, found 30"));
  EXPECT_THAT(ErrorOf(DecodeRaw16({}, 1 << 20, 1 << 20)), HasSubstr("at most"));
}

TEST(DecodeZlib16, AcceptsExactlyTheImage) {
  const std::vector<uint8_t> code = Compressed(CountingBytes());
  const auto depth = DecodeZlib16(code, kColumns, kRows);
  ASSERT_TRUE(depth) << depth.error().message;
  EXPECT_EQ(*depth, *DecodeRaw16(CountingBytes(), kColumns, kRows));
  EXPECT_THAT(ErrorOf(DecodeZlib16(code, kColumns, kRows + 1)),
              HasSubstr("expected 40 bytes for 5x4 pixels, found 30"));
  EXPECT_THAT(ErrorOf(DecodeZlib16(code, kColumns, kRows - 1)), HasSubstr("expected 20 bytes"));
  std::vector<uint8_t> longer = code;
  longer.push_back(0);
  EXPECT_THAT(ErrorOf(DecodeZlib16(longer, kColumns, kRows)), HasSubstr("1 bytes after it"));
  for (size_t size = 0; size < code.size(); ++size) {
    const std::vector<uint8_t> cut(code.begin(), code.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_THAT(ErrorOf(DecodeZlib16(cut, kColumns, kRows)), HasSubstr("zlib depth")) << size;
  }
  // 64 MB in 64 kB.
  EXPECT_THAT(ErrorOf(DecodeZlib16(Compressed(std::vector<uint8_t>(size_t{1} << 26)), 640, 480)),
              HasSubstr("expected 614400 bytes"));
}

TEST(DecodeRawFloat, WhatIsNotMeasuredIsNaN) {
  const float values[] = {
      1.5F, 0, -1, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
      1e30F};
  std::vector<uint8_t> bytes(sizeof(values));
  std::memcpy(bytes.data(), values, sizeof(values));
  const auto depth = DecodeRawFloat(bytes, 6, 1);
  ASSERT_TRUE(depth) << depth.error().message;
  EXPECT_EQ((*depth)(0, 0), 1.5F);
  for (int u = 1; u < 6; ++u) EXPECT_TRUE(std::isnan((*depth)(0, u))) << u;
  EXPECT_THAT(ErrorOf(DecodeRawFloat(bytes, 5, 1)), HasSubstr("of 4 bytes, 20 bytes in all"));
}

TEST(DecodeColor, PutsTheChannelsOfEveryEncodingInOrder) {
  const Rgb8 orange{250, 120, 10};
  const auto first = [](ColorEncoding encoding, std::vector<uint8_t> bytes) {
    const auto image = DecodeColor(encoding, bytes, 1, 1);
    EXPECT_TRUE(image) << ErrorOf(image);
    return image ? (*image)(0, 0) : Rgb8{};
  };
  EXPECT_EQ(first(ColorEncoding::kRgb, {250, 120, 10}), orange);
  EXPECT_EQ(first(ColorEncoding::kBgr, {10, 120, 250}), orange);
  EXPECT_EQ(first(ColorEncoding::kRgba, {250, 120, 10, 9}), orange);
  EXPECT_EQ(first(ColorEncoding::kBgra, {10, 120, 250, 9}), orange);
  EXPECT_EQ(first(ColorEncoding::kGrey, {77}), (Rgb8{77, 77, 77}));
  std::vector<uint8_t> png;
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(1, 1, CV_8UC3, cv::Scalar(10, 120, 250)), png));
  EXPECT_EQ(first(ColorEncoding::kPng, png), orange);
}

TEST(DecodeColor, SaysWhatWasExpectedAndFound) {
  EXPECT_THAT(ErrorOf(DecodeColor(ColorEncoding::kBgra, std::vector<uint8_t>(9), 3, 1)),
              HasSubstr("expected 3x1 pixels of 4 bytes, 12 bytes in all, found 9"));
  const std::vector<uint8_t> jpeg = EncodeJpeg(Image<Rgb8>(4, 2));
  EXPECT_THAT(ErrorOf(CheckColorSize(ColorEncoding::kJpeg, jpeg, 4, 3)),
              HasSubstr("the image is 4x2; expected 4x3"));
  EXPECT_TRUE(CheckColorSize(ColorEncoding::kJpeg, jpeg, 4, 2));
  EXPECT_TRUE(CheckColorSize(ColorEncoding::kPng, std::vector<uint8_t>(5), 4, 2))
      << "decoding tells of damage";
  EXPECT_THAT(ErrorOf(DecodeColor(ColorEncoding::kPng, std::vector<uint8_t>(5), 4, 2)),
              HasSubstr("PNG"));
}

TEST(DecodePng16, ChecksTheHeaderBeforeItAllocates) {
  std::vector<uint8_t> png;
  const cv::Mat depth(kRows, kColumns, CV_16UC1, cv::Scalar(1234));
  ASSERT_TRUE(cv::imencode(".png", depth, png));
  EXPECT_EQ((*DecodePng16(png, kColumns, kRows))(2, 4), 1234);
  EXPECT_THAT(ErrorOf(DecodePng16(png, 6, 3)), HasSubstr("size is 5x3; expected 6x3"));
  std::vector<uint8_t> bomb = png;
  bomb[16] = 0x7f;  // the highest byte of the width
  EXPECT_THAT(ErrorOf(DecodePng16(bomb)), HasSubstr("at most"));
  std::vector<uint8_t> cut(png.begin(), png.end() - 12);
  EXPECT_THAT(ErrorOf(DecodePng16(cut, kColumns, kRows)), HasSubstr("truncated"));
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(kRows, kColumns, CV_8UC1, cv::Scalar(9)), png));
  EXPECT_THAT(ErrorOf(DecodePng16(png)),
              HasSubstr("expected a 16-bit image with one channel, found "
                        "8-bit grey"));
}

}  // namespace
}  // namespace vismap
