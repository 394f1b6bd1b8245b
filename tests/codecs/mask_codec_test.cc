#include "codecs/mask_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/mutations.h"

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Image<uint8_t> RandomImage(int width, int height, uint64_t seed, uint64_t one_in) {
  TestRandom random(seed);
  Image<uint8_t> image(width, height);
  for (uint8_t& pixel : image.pixels()) pixel = random.Below(one_in) == 0;
  return image;
}

TEST(Mask, FromImageIsItsBoundingBox) {
  Image<uint8_t> image(10, 8);
  image(2, 3) = 1;
  image(5, 7) = 255;
  const Mask mask = MaskFromImage(image);
  EXPECT_EQ(mask.u0, 3);
  EXPECT_EQ(mask.v0, 2);
  EXPECT_EQ(mask.inside.width(), 5);
  EXPECT_EQ(mask.inside.height(), 4);
  for (int v = 0; v < 8; ++v) {
    for (int u = 0; u < 10; ++u) EXPECT_EQ(mask.Contains(v, u), image(v, u) != 0);
  }
  EXPECT_EQ(mask.inside(3, 4), 1);
}

TEST(Mask, RunsGoDownColumnsAndBeginWithOutside) {
  Image<uint8_t> image(3, 2);
  image.pixels() = {1, 0, 0,  //
                    1, 1, 0};
  EXPECT_THAT(EncodeMask(MaskFromImage(image)), ElementsAre(0, 2, 1, 1, 2));
  EXPECT_THAT(EncodeMask(MaskFromImage(Image<uint8_t>(3, 2))), ElementsAre(6));
  EXPECT_THAT(EncodeMask(MaskFromImage(Image<uint8_t>(3, 2, 1))), ElementsAre(0, 6));
}

TEST(Mask, RoundTripsThroughRunsAndText) {
  for (const uint64_t one_in : {1, 2, 5, 50, 1000, 1000000}) {
    const Mask mask = MaskFromImage(RandomImage(41, 29, one_in, one_in));
    const MaskRuns runs = EncodeMask(mask);
    const Result<MaskRuns> read = RunsFromString(RunsToString(runs));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, runs);
    const Result<Mask> decoded = DecodeMask(*read, 41, 29);
    ASSERT_TRUE(decoded) << decoded.error().message;
    EXPECT_EQ(*decoded, mask);
  }
}

TEST(Mask, ALooseBoxIsTightAfterARoundTrip) {
  Mask mask{.image_width = 20, .image_height = 10, .u0 = 2, .v0 = 1, .inside = {}};
  mask.inside = Image<uint8_t>(8, 7);
  mask.inside(3, 4) = 1;
  const Result<Mask> decoded = DecodeMask(EncodeMask(mask), 20, 10);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->inside.size(), 1u);
  EXPECT_TRUE(decoded->Contains(4, 6));
}

// The strings are what rleToString of the COCO API gives for these runs.
TEST(MaskText, AgreesWithTheCocoApi) {
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{6}), "6");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{0, 6}), "06");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{16}), "`0");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{5, 3, 2, 3, 2}), "53200");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{307200}), "PP\\9");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{10, 20, 30, 10}), ":d0n0F");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{0, 1, 4294967295, 0}), "01oooooo3O");
  EXPECT_EQ(RunsToString(std::vector<uint32_t>{0, 4294967295, 0, 0, 1000}), "0oooooo30QPPPPPLXo0");
}

TEST(MaskText, NamesWhatIsWrong) {
  EXPECT_THAT(RunsFromString("6/").error().message, HasSubstr("character 1"));
  EXPECT_THAT(RunsFromString("6p").error().message, HasSubstr("character 1"));
  EXPECT_THAT(RunsFromString("6`").error().message, HasSubstr("cut off"));
  EXPECT_THAT(RunsFromString("@").error().message, HasSubstr("run 0 is -16"));
  EXPECT_THAT(RunsFromString("oooooooooo").error().message, HasSubstr("character 8"));
  EXPECT_THAT(RunsFromString("oooooo?").error().message, HasSubstr("run 0 is"));
  EXPECT_TRUE(RunsFromString("")->empty());
}

TEST(MaskRuns, MustFillTheImageExactly) {
  EXPECT_TRUE(DecodeMask(std::vector<uint32_t>{3, 3}, 3, 2));
  EXPECT_THAT(DecodeMask(std::vector<uint32_t>{3, 2}, 3, 2).error().message,
              HasSubstr("add up to 5; expected 3x2 = 6"));
  EXPECT_FALSE(DecodeMask(std::vector<uint32_t>{3, 4}, 3, 2));
  EXPECT_FALSE(DecodeMask(std::vector<uint32_t>{UINT32_MAX, UINT32_MAX, 8}, 3, 2));
  EXPECT_FALSE(DecodeMask({}, 3, 2));
  EXPECT_FALSE(DecodeMask({}, 0, 0));
  EXPECT_FALSE(DecodeMask(std::vector<uint32_t>{0, UINT32_MAX}, 65535, 65537));
}

TEST(MaskText, MutationsGiveAMaskOrAnError) {
  const std::string text = RunsToString(EncodeMask(MaskFromImage(RandomImage(30, 20, 1, 4))));
  const std::vector<uint8_t> bytes(text.begin(), text.end());
  ForEachMutation(bytes, 5000, [](const std::vector<uint8_t>& bad) {
    const Result<MaskRuns> runs = RunsFromString(std::string(bad.begin(), bad.end()));
    if (!runs) return;
    EXPECT_EQ(RunsFromString(RunsToString(*runs)), *runs);
    const Result<Mask> mask = DecodeMask(*runs, 30, 20);
    EXPECT_TRUE(!mask || *DecodeMask(EncodeMask(*mask), 30, 20) == *mask);
  });
}

}  // namespace
}  // namespace vismap
