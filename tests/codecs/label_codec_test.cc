#include "codecs/label_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/zstd_codec.h"
#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

SegmentImage Patches(int width, int height, int count, uint64_t seed) {
  TestRandom random(seed);
  SegmentImage image{Image<SegmentIndex>(width, height, SegmentIndex::kNone), count};
  SegmentIndex now = SegmentIndex::kNone;
  for (SegmentIndex& pixel : image.index.pixels()) {
    if (random.Below(5) == 0) {
      now = static_cast<SegmentIndex>(static_cast<int>(random.Below(uint64_t(count) + 1)) - 1);
    }
    pixel = now;
  }
  return image;
}

void ExpectSame(const SegmentImage& a, const SegmentImage& b) {
  EXPECT_EQ(a.index, b.index);
  EXPECT_EQ(a.segment_count, b.segment_count);
}

TEST(LabelCodec, IsLossless) {
  for (const int count : {0, 1, 2, 127, 128, 300}) {
    const SegmentImage image = Patches(37, 23, count, 5);
    const auto decoded = DecodeSegmentImage(EncodeSegmentImage(image), 37, 23);
    ASSERT_TRUE(decoded) << decoded.error().message;
    ExpectSame(*decoded, image);
  }
}

TEST(LabelCodec, KeepsSegmentsWithoutPixels) {
  const SegmentImage image{Image<SegmentIndex>(4, 4, SegmentIndex::kNone), 16};
  ExpectSame(*DecodeSegmentImage(EncodeSegmentImage(image), 4, 4), image);
}

TEST(LabelCodec, RefusesToEncodeWhatItCouldNotDecode) {
  SegmentImage image{Image<SegmentIndex>(2, 1, SegmentIndex::kNone), 1};
  image.index(0, 1) = SegmentIndex{1};
  EXPECT_THROW(EncodeSegmentImage(image), std::logic_error);
  image.index(0, 1) = SegmentIndex{-2};
  EXPECT_THROW(EncodeSegmentImage(image), std::logic_error);
  image = {Image<SegmentIndex>(2, 1, SegmentIndex::kNone), 3};
  EXPECT_THROW(EncodeSegmentImage(image), std::logic_error);
}

Result<SegmentImage> DecodeContent(const std::vector<uint8_t>& content, int width, int height) {
  return DecodeSegmentImage(CompressBytes(content), width, height);
}

TEST(LabelCodec, NamesWhatIsWrong) {
  // segment_count, then (run, index + 1)
  EXPECT_TRUE(DecodeContent({2, 3, 1, 1, 2}, 4, 1));
  EXPECT_THAT(DecodeContent({2, 3, 3, 1, 2}, 4, 1).error().message,
              HasSubstr("segment index 2 is beyond the 2 segments"));
  EXPECT_THAT(DecodeContent({2, 3, 1}, 4, 1).error().message, HasSubstr("fill exactly 4"));
  EXPECT_THAT(DecodeContent({2, 5, 1}, 4, 1).error().message, HasSubstr("fill exactly 4"));
  EXPECT_THAT(DecodeContent({2, 0, 1, 4, 1}, 4, 1).error().message, HasSubstr("fill exactly 4"));
  EXPECT_THAT(DecodeContent({2, 4, 1, 9}, 4, 1).error().message, HasSubstr("after the last run"));
  EXPECT_THAT(DecodeContent({5, 4, 1}, 4, 1).error().message, HasSubstr("segment count"));
  EXPECT_THAT(DecodeContent({0xff, 0xff, 0xff, 0xff, 0xff, 1, 4, 1}, 4, 1).error().message,
              HasSubstr("segment count"));
  EXPECT_THAT(DecodeContent({0xff, 0xff, 0xff, 0xff, 0x7f, 4, 1}, 4, 1).error().message,
              HasSubstr("segment count"));
  EXPECT_FALSE(DecodeContent({2, 4, 1}, 4, 0));
}

TEST(LabelCodec, MutationsOfCodeAndContentGiveAValueOrAnError) {
  const std::vector<uint8_t> code = EncodeSegmentImage(Patches(37, 23, 12, 5));
  ForEachMutation(code, 3000, [](const std::vector<uint8_t>& bytes) {
    const auto image = DecodeSegmentImage(bytes, 37, 23);
    EXPECT_TRUE(!image || image->index.size() == 37u * 23u);
  });
  ForEachMutation(*DecompressBytes(code, 1, 1 << 20), 3000, [](const std::vector<uint8_t>& bytes) {
    const auto image = DecodeContent(bytes, 37, 23);
    if (!image) return;
    for (const SegmentIndex index : image->index.pixels()) {
      EXPECT_GE(Raw(index), -1);
      EXPECT_LT(Raw(index), image->segment_count);
    }
  });
}

}  // namespace
}  // namespace vismap
