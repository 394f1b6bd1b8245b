#include "segmentation/split_segments.h"

#include <gtest/gtest.h>

#include "support/random_scenes.h"
#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

SegmentCounts Split(const DetectionSet& set, const RefineOptions& options) {
  const PixelOwnership ownership(set, options, kWidth, kHeight);
  return SplitSegments(CountSegments(Halves(), ownership), ownership, options);
}

TEST(SplitSegments, APartOfASegmentBecomesTheLastSegment) {
  const SegmentCounts counts = Split(Set({Rectangle(kCup, 0.9F, 30, 60, 30, 30)}), {});
  EXPECT_EQ(counts.image.segment_count, 3);
  EXPECT_EQ(counts.pixels, (std::vector<int32_t>{100 * 140 - 900, 100 * 140, 900}));
  EXPECT_EQ(counts.inside[0], (std::vector<int32_t>{0, 0, 900}));
  EXPECT_EQ(counts.image.index(60, 30), SegmentIndex{2});
  EXPECT_EQ(counts.image.index(60, 29), SegmentIndex{0});
}

TEST(SplitSegments, MasksOfSeveralSegmentsCutOnlyTheirMainOne) {
  // 80 % of the mask lies in segment 0: the rest of it stays in segment 1.
  const DetectionSet set = Set({Rectangle(kCup, 0.9F, 60, 60, 50, 30)});
  const SegmentCounts counts = Split(set, {});
  EXPECT_EQ(counts.inside[0], (std::vector<int32_t>{0, 10 * 30, 40 * 30}));
  RefineOptions strict;
  strict.split_min_mask_part = 0.81;
  EXPECT_EQ(Split(set, strict).image.segment_count, 2);
}

TEST(SplitSegments, CountsAreThoseOfTheNewImage) {
  RandomNumbers random(2);
  int splits = 0;
  for (int round = 0; round < 40; ++round) {
    RefineOptions options;
    options.split_min_score = 0;
    options.resolve_overlaps = random.Chance(0.5);
    std::vector<Detection> detections;
    for (int k = 0; k < 5; ++k) {
      detections.push_back(Rectangle(kCup, static_cast<float>(random.Real(0, 1)),
                                     random.Whole(-20, 150), random.Whole(-20, 120),
                                     random.Whole(10, 90), random.Whole(10, 90)));
    }
    const DetectionSet set = Set(std::move(detections));
    const SegmentCounts counts = Split(set, options);
    splits += counts.image.segment_count - 2;
    const PixelOwnership ownership(set, options, kWidth, kHeight);
    const SegmentCounts again = CountSegments(counts.image, ownership);
    EXPECT_EQ(counts.pixels, again.pixels);
    for (size_t rank = 0; rank < again.inside.size(); ++rank) {
      std::vector<int32_t> inside = counts.inside[rank];
      inside.resize(again.pixels.size());
      EXPECT_EQ(inside, again.inside[rank]) << "round " << round;
    }
  }
  EXPECT_GT(splits, 20);
}

}  // namespace
}  // namespace vismap
