#include "codecs/depth_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/zstd_codec.h"
#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

Image<uint16_t> Noise(int width, int height, uint64_t seed, uint64_t range) {
  TestRandom random(seed);
  Image<uint16_t> image(width, height);
  for (uint16_t& pixel : image.pixels()) pixel = static_cast<uint16_t>(random.Below(range));
  return image;
}

TEST(DepthCodec, IsLossless) {
  for (const uint64_t range : {1, 2, 300, 65536}) {
    for (const auto& [width, height] : {std::pair(1, 1), {1, 9}, {9, 1}, {64, 48}, {33, 7}}) {
      const Image<uint16_t> image = Noise(width, height, range, range);
      const auto decoded = DecodeDepth(EncodeDepth(image), width, height);
      ASSERT_TRUE(decoded) << decoded.error().message;
      EXPECT_EQ(*decoded, image);
    }
  }
}

TEST(DepthCodec, KeepsExtremeSteps) {
  Image<uint16_t> image(6, 1);
  image.pixels() = {0, 65535, 0, 32768, 65535, 1};
  EXPECT_EQ(*DecodeDepth(EncodeDepth(image), 6, 1), image);
}

TEST(DepthCodec, ASmoothSurfaceTakesLittle) {
  Image<uint16_t> image(640, 480);
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) image(v, u) = static_cast<uint16_t>(1000 + u / 4 + v / 2);
  }
  EXPECT_LT(EncodeDepth(image).size(), image.size() * 2 / 50);
}

TEST(DepthCodec, RefusesAnotherSize) {
  const std::vector<uint8_t> bytes = EncodeDepth(Noise(8, 6, 1, 100));
  EXPECT_THAT(DecodeDepth(bytes, 8, 7).error().message, HasSubstr("96 bytes; expected 112"));
  EXPECT_FALSE(DecodeDepth(bytes, 4, 6));
  EXPECT_FALSE(DecodeDepth(bytes, 0, 6));
  EXPECT_FALSE(DecodeDepth(bytes, -8, -6));
  EXPECT_FALSE(DecodeDepth(bytes, 1 << 30, 1 << 30));
  EXPECT_THAT(DecodeDepth(bytes, 8, 6, 47).error().message, HasSubstr("at most 47 pixels"));
}

TEST(DepthCodec, RefusesTrailingBytesAndASecondFrame) {
  std::vector<uint8_t> bytes = EncodeDepth(Noise(8, 6, 1, 100));
  std::vector<uint8_t> twice = bytes;
  twice.insert(twice.end(), bytes.begin(), bytes.end());
  EXPECT_THAT(DecodeDepth(twice, 8, 6).error().message, HasSubstr("bytes after it"));
  bytes.push_back(0);
  EXPECT_THAT(DecodeDepth(bytes, 8, 6).error().message, HasSubstr("1 bytes after it"));
}

TEST(DepthCodec, EveryTruncationIsAnErrorAndEveryFlipAnErrorOrTheSameImage) {
  const Image<uint16_t> image = Noise(40, 30, 3, 500);
  int accepted = 0;
  ForEachMutation(EncodeDepth(image), 5000, [&](const std::vector<uint8_t>& bytes) {
    const auto decoded = DecodeDepth(bytes, 40, 30);
    accepted += decoded.has_value() ? 1 : 0;
    // Some bits of the header have no meaning, and the new byte may equal the old one.
    EXPECT_EQ(decoded.value_or(image), image);
  });
  EXPECT_LT(accepted, 200);
}

TEST(ZstdCodec, RefusesAFrameThatStatesNoOrTooMuchContent) {
  const std::vector<uint8_t> code = CompressBytes(std::vector<uint8_t>(1000, 1));
  EXPECT_TRUE(DecompressBytes(code, 1000, 1000));
  EXPECT_FALSE(DecompressBytes(code, 0, 999));
  EXPECT_FALSE(DecompressBytes(code, 1001, 2000));
  EXPECT_FALSE(DecompressBytes({}, 0, 10));
}

}  // namespace
}  // namespace vismap
