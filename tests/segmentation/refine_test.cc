#include "segmentation/refine.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_scenes.h"
#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

SegmentedFrame Refine(std::vector<Detection> detections, const RefineOptions& options = {}) {
  const DetectionSet set = Set(std::move(detections));
  return RefineWithDetections(Frame(), Halves(), &set, options);
}

/// Checks the properties that hold for every input.
void ExpectConsistent(const SegmentedFrame& out) {
  ASSERT_EQ(static_cast<int>(out.segments.size()), out.image.segment_count);
  std::vector<int> pixels(out.segments.size());
  for (const SegmentIndex index : out.image.index.pixels()) {
    if (index == SegmentIndex::kNone) continue;
    ASSERT_LT(Raw(index), out.image.segment_count);
    ++pixels[static_cast<size_t>(Raw(index))];
  }
  for (size_t i = 0; i < pixels.size(); ++i) {
    EXPECT_EQ(out.segments[i].pixels, pixels[i]);
    EXPECT_EQ(out.segments[i].overlap > 0, out.segments[i].detection != DetectionIndex::kNone);
    EXPECT_LE(out.segments[i].overlap, 1);
  }
}

TEST(Refine, WithoutDetectorSegmentsAreOnlyCounted) {
  const SegmentedFrame out = RefineWithDetections(Frame(), Halves(), nullptr, RefineOptions{});
  ExpectConsistent(out);
  EXPECT_FALSE(out.had_detections);
  ASSERT_EQ(out.segments.size(), 2u);
  EXPECT_EQ(out.segments[0].pixels, 100 * 140);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex::kNone);
}

TEST(Refine, ADetectorThatFoundNothingStillProcessedTheFrame) {
  const SegmentedFrame out = Refine({});
  EXPECT_TRUE(out.had_detections);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex::kNone);
}

TEST(Refine, SegmentGetsTheMaskThatCoversIt) {
  const SegmentedFrame out = Refine({Rectangle(kChair, 0.9F, 90, 0, 110, kHeight)});
  ExpectConsistent(out);
  ASSERT_EQ(out.segments.size(), 2u);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex::kNone);
  EXPECT_EQ(out.segments[1].detection, DetectionIndex{0});
  EXPECT_EQ(out.segments[1].class_id, kChair);
  EXPECT_FLOAT_EQ(out.segments[1].score, 0.9F);
  EXPECT_FLOAT_EQ(out.segments[1].overlap, 1.0F);
}

TEST(Refine, SeveralDetectionsOfOneThingAreOne) {
  // Each alone covers too little of the segment.
  const Detection upper = Rectangle(kChair, 0.7F, 100, 10, 100, 90);
  const Detection lower = Rectangle(kChair, 0.9F, 100, 30, 100, 90);
  RefineOptions options;
  options.split = false;
  const SegmentedFrame joined = Refine({upper, lower}, options);
  ExpectConsistent(joined);
  EXPECT_EQ(joined.segments[1].detection, DetectionIndex{1});
  EXPECT_FLOAT_EQ(joined.segments[1].score, 0.9F);
  EXPECT_NEAR(joined.segments[1].overlap, 110.0 / 140, 1e-3);
  options.same_part = 1;
  EXPECT_EQ(Refine({upper, lower}, options).segments[1].detection, DetectionIndex::kNone);
}

TEST(Refine, AMaskOnAMuchLargerOneOfItsClassIsAnotherThing) {
  const SegmentedFrame out =
      Refine({Rectangle(kChair, 0.8F, 0, 10, 200, 140), Rectangle(kChair, 0.9F, 100, 10, 60, 140)});
  ExpectConsistent(out);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex{0});
  ASSERT_EQ(out.segments.size(), 3u);
  EXPECT_EQ(out.segments[2].detection, DetectionIndex{1});
}

TEST(Refine, ASecondMaskThatIsTooLargeGetsNoPixelOfAnotherThing) {
  const SegmentedFrame out = Refine({Rectangle(kChair, 0.9F, 0, 0, 100, kHeight),
                                     Rectangle(kChair, 0.8F, 0, 0, 150, kHeight),
                                     Rectangle(kChair, 0.6F, 100, 0, 100, kHeight)});
  ExpectConsistent(out);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex{0});
  EXPECT_EQ(out.segments[1].detection, DetectionIndex{2});
}

TEST(Refine, OverlapMustExceedTheThreshold) {
  RefineOptions options;
  options.split = false;
  options.min_overlap = 0.5;
  EXPECT_EQ(Refine({Rectangle(kChair, 0.9F, 150, 0, 50, kHeight)}, options).segments[1].detection,
            DetectionIndex::kNone);  // exactly 0.5
  const auto out = Refine({Rectangle(kChair, 0.9F, 149, 0, 51, kHeight)}, options);
  EXPECT_EQ(out.segments[1].detection, DetectionIndex{0});
  EXPECT_FLOAT_EQ(out.segments[1].overlap, 0.51F);
}

TEST(Refine, OneMaskMayHoldSeveralSegments) {
  const SegmentedFrame out = Refine({Rectangle(kTable, 0.8F, 0, 0, kWidth, kHeight)});
  EXPECT_EQ(out.segments[0].detection, DetectionIndex{0});
  EXPECT_EQ(out.segments[1].detection, DetectionIndex{0});
}

TEST(Refine, DetectionsBelowTheMinimumScoreAreIgnored) {
  RefineOptions options;
  options.min_score = 0.5;
  const SegmentedFrame out = Refine({Rectangle(kTable, 0.4F, 0, 0, kWidth, kHeight)}, options);
  EXPECT_TRUE(out.had_detections);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex::kNone);
}

TEST(Refine, TiesGoToTheHigherScoreThenTheSmallerMaskThenTheLowerIndex) {
  RefineOptions options;
  options.resolve_overlaps = false;
  options.split = false;
  const auto first = [&](std::vector<Detection> detections) {
    return Raw(Refine(std::move(detections), options).segments[0].detection);
  };
  const Detection low = Rectangle(kTable, 0.6F, 0, 0, kWidth, kHeight);
  const Detection high = Rectangle(kChair, 0.7F, 0, 0, kWidth, kHeight);
  const Detection smaller = Rectangle(kCup, 0.6F, 0, 0, 100, kHeight);
  EXPECT_EQ(first({low, high}), 1);
  EXPECT_EQ(first({high, low}), 0);
  EXPECT_EQ(first({low, smaller}), 1);
  EXPECT_EQ(first({low, low}), 0);
}

TEST(Refine, GoodMaskCutsTheCupOutOfTheTable) {
  const SegmentedFrame out = Refine({Rectangle(kCup, 0.9F, 30, 60, 30, 30)});
  ExpectConsistent(out);
  ASSERT_EQ(out.segments.size(), 3u);
  EXPECT_EQ(out.segments[2].class_id, kCup);
  EXPECT_EQ(out.segments[2].pixels, 900);
  EXPECT_EQ(out.image.index(60, 30), SegmentIndex{2});
  EXPECT_EQ(out.image.index(59, 30), SegmentIndex{0});
  EXPECT_EQ(out.segments[0].detection, DetectionIndex::kNone);
}

TEST(Refine, TableAroundTheCupStillGetsItsOwnMask) {
  const SegmentedFrame out =
      Refine({Rectangle(kTable, 0.8F, 0, 0, 100, kHeight), Rectangle(kCup, 0.9F, 30, 60, 30, 30)});
  ExpectConsistent(out);
  ASSERT_EQ(out.segments.size(), 3u);
  EXPECT_EQ(out.segments[0].class_id, kTable);
  EXPECT_FLOAT_EQ(out.segments[0].overlap, 1.0F);
  EXPECT_EQ(out.segments[2].class_id, kCup);
}

TEST(Refine, PoorOrTornMasksDoNotSplit) {
  EXPECT_EQ(Refine({Rectangle(kCup, 0.3F, 30, 60, 30, 30)}).segments.size(), 2u);  // score
  EXPECT_EQ(Refine({Rectangle(kCup, 0.9F, 30, 60, 5, 5)}).segments.size(), 2u);    // size
  EXPECT_EQ(Refine({Rectangle(kCup, 0.9F, 85, 60, 30, 30)}).segments.size(), 2u);  // on both
  EXPECT_EQ(Refine({Rectangle(kCup, 0.9F, 0, 0, 100, 149)}).segments.size(), 2u);  // nearly all
  RefineOptions off;
  off.split = false;
  EXPECT_EQ(Refine({Rectangle(kCup, 0.9F, 30, 60, 30, 30)}, off).segments.size(), 2u);
}

TEST(Refine, TheBorderOfAMaskOnTheBackgroundIsNotCutOut) {
  // The chair is segment 1; its mask covers 8 columns of segment 0 as well.
  const SegmentedFrame out = Refine({Rectangle(kChair, 0.95F, 92, 0, 108, kHeight)});
  ASSERT_EQ(out.segments.size(), 2u);
  EXPECT_EQ(out.segments[0].pixels, 100 * 140);
  EXPECT_EQ(out.segments[1].class_id, kChair);
}

TEST(Refine, WallSeenThroughTheObjectGetsNoDetection) {
  RgbdFrame frame = Frame();  // the mask is 0.5 m wide and 0.6 m high at 1 m
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < 100; ++u) frame.depth(v, u) = 2.5F;
  }
  SegmentImage image = Halves();
  for (int v = 10; v < kHeight; ++v) {
    for (int u = 0; u < 80; ++u) image.index(v, u) = SegmentIndex::kNone;
  }
  DetectionSet set;
  set.detections = {Rectangle(kChair, 0.9F, 78, 20, 100, 130)};
  RefineOptions options;
  options.max_depth_extent = 0;
  SegmentedFrame out = RefineWithDetections(frame, image, &set, options);
  EXPECT_EQ(out.segments[0].class_id, kChair);
  EXPECT_EQ(out.segments[1].class_id, kChair);
  out = RefineWithDetections(frame, image, &set, RefineOptions{});
  EXPECT_EQ(out.segments[0], (FrameSegment{.pixels = 20 * 140}));
  EXPECT_EQ(out.segments[1].class_id, kChair);
}

TEST(Refine, PixelInTwoMasksBelongsToTheBetterOne) {
  const std::vector<Detection> both{Rectangle(kTable, 0.6F, 0, 0, kWidth, kHeight),
                                    Rectangle(kChair, 0.9F, 100, 0, 100, kHeight)};
  const SegmentedFrame resolved = Refine(both);
  EXPECT_EQ(resolved.segments[0].class_id, kTable);
  EXPECT_EQ(resolved.segments[1].class_id, kChair);
}

TEST(Refine, MasksThatReachOutOfTheImageAreCut) {
  const SegmentedFrame out =
      Refine({Rectangle(kTable, 0.8F, -50, -50, 1000, 1000),
              Rectangle(kCup, 0.8F, 500, 500, 10, 10), Rectangle(kCup, 0.8F, 10, 10, 0, 0)});
  ExpectConsistent(out);
  EXPECT_EQ(out.segments[0].detection, DetectionIndex{0});
}

TEST(Refine, OrderOfDetectionsWithDistinctScoresDoesNotMatter) {
  std::vector<Detection> detections{
      Rectangle(kTable, 0.71F, 0, 0, 150, kHeight), Rectangle(kCup, 0.9F, 30, 60, 30, 30),
      Rectangle(kChair, 0.8F, 95, 20, 105, 100), Rectangle(kCup, 0.75F, 50, 70, 40, 40)};
  const SegmentedFrame forward = Refine(detections);
  std::reverse(detections.begin(), detections.end());
  const SegmentedFrame backward = Refine(detections);
  ExpectConsistent(forward);
  EXPECT_EQ(forward.image.index, backward.image.index);
  ASSERT_EQ(forward.segments.size(), backward.segments.size());
  for (size_t i = 0; i < forward.segments.size(); ++i) {
    EXPECT_EQ(forward.segments[i].class_id, backward.segments[i].class_id);
    EXPECT_EQ(forward.segments[i].score, backward.segments[i].score);
  }
}

TEST(Refine, PixelsOnAFoldGoToTheMaskTheyLieInAndNoOthersDo) {
  // The mask ends at column 106, the segment at 100; the fold is six columns wide on either side.
  SegmentImage image = Halves();
  image.edge_strength = Image<uint8_t>(kWidth, kHeight);
  for (int v = 10; v < kHeight; ++v) {
    for (int u = 94; u < 104; ++u) image.edge_strength(v, u) = 50;
  }
  DetectionSet set;
  set.detections = {Rectangle(kChair, 0.9F, 0, 10, 106, kHeight - 10)};
  const auto moved = [&](const RefineOptions& options) {
    const SegmentedFrame out = RefineWithDetections(Frame(), image, &set, options);
    ExpectConsistent(out);
    int columns = 0;
    for (int u = 100; u < kWidth; ++u) columns += Raw(out.image.index(80, u)) == 0;
    return columns;
  };
  EXPECT_EQ(moved({}), 4);  // the mask covers six columns, four of them on the fold
  RefineOptions off;
  off.fold_min_score = 2;
  EXPECT_EQ(moved(off), 0);
  RefineOptions strict;
  strict.fold_min_score = 0.95;
  EXPECT_EQ(moved(strict), 0);
}

/// Halves with two loose pieces of 8x20 pixels: 0 in the right segment, 1 in none.
SegmentImage HalvesWithLoosePieces() {
  SegmentImage image = Halves();
  for (int v = 110; v < 130; ++v) {
    for (int u = 140; u < 148; ++u) image.index(v, u) = SegmentIndex::kNone;
    image.loose.push_back({v, 120, 128, 0});
    image.loose.push_back({v, 140, 148, 1});
  }
  return image;
}

TEST(Refine, LoosePiecesGoToTheObjectWhoseMaskCoversThem) {
  DetectionSet set;  // a chair whose mask reaches over a part of the other segment
  set.detections = {Rectangle(kChair, 0.6F, 0, 10, 135, kHeight - 10)};
  const auto taken = [&](const RefineOptions& options) {
    const SegmentedFrame out =
        RefineWithDetections(Frame(), HalvesWithLoosePieces(), &set, options);
    ExpectConsistent(out);
    EXPECT_TRUE(out.image.loose.empty());
    EXPECT_EQ(Raw(out.image.index(115, 110)), 1);  // in the mask, but not of a loose piece
    EXPECT_EQ(out.image.index(115, 143), SegmentIndex::kNone);  // outside the mask
    return Raw(out.image.index(115, 123)) == 0;
  };
  EXPECT_TRUE(taken({}));
  RefineOptions off;
  off.take_loose = false;
  EXPECT_FALSE(taken(off));
  set.detections = {Rectangle(kChair, 0.6F, 0, 10, 125, kHeight - 10)};  // covers 5 of 8 columns
  EXPECT_FALSE(taken({}));
}

TEST(Refine, LoosePiecesWithoutSegmentAreAttachedToo) {
  DetectionSet set;
  set.detections = {Rectangle(kChair, 0.6F, 0, 10, 150, kHeight - 10)};
  const SegmentedFrame out = RefineWithDetections(Frame(), HalvesWithLoosePieces(), &set, {});
  ExpectConsistent(out);
  EXPECT_EQ(Raw(out.image.index(115, 143)), 0);
  EXPECT_EQ(out.segments[0].pixels, 100 * (kHeight - 10) + 2 * 8 * 20);
}

TEST(Refine, LoosePiecesSeenThroughTheObjectStay) {
  DetectionSet set;  // a chair 1 m away, of 0.7 m
  set.detections = {Rectangle(kChair, 0.6F, 0, 10, 135, kHeight - 10)};
  const auto taken = [&](float depth, const RefineOptions& options) {
    RgbdFrame frame = Frame();
    for (int v = 110; v < 130; ++v) {
      for (int u = 120; u < 128; ++u) frame.depth(v, u) = depth;
    }
    const SegmentedFrame out = RefineWithDetections(frame, HalvesWithLoosePieces(), &set, options);
    return Raw(out.image.index(115, 123)) == 0;
  };
  EXPECT_TRUE(taken(1.6F, {}));
  EXPECT_FALSE(taken(1.8F, {}));
  RefineOptions far;
  far.loose_depth_extent = 1.5;
  EXPECT_TRUE(taken(1.8F, far));
  EXPECT_FALSE(taken(9, far));
  far.loose_depth_extent = 0;
  EXPECT_TRUE(taken(9, far));
}

TEST(Refine, LoosePiecesOfAnotherObjectStay) {
  DetectionSet set;
  set.detections = {Rectangle(kChair, 0.6F, 0, 10, 135, kHeight - 10),
                    Rectangle(kTable, 0.5F, 100, 0, 100, kHeight)};
  RefineOptions options;
  options.resolve_overlaps = false;
  const SegmentedFrame out = RefineWithDetections(Frame(), HalvesWithLoosePieces(), &set, options);
  EXPECT_EQ(Raw(out.image.index(115, 123)), 1);
}

TEST(Refine, OverlapsAreThoseOfTheSegmentsAfterAllSplits) {
  RandomNumbers random(3);
  int splits = 0, matches = 0;
  for (int round = 0; round < 60; ++round) {
    RefineOptions options;
    options.same_part = 1;
    options.max_depth_extent = 0;
    options.take_loose = false;
    options.fold_min_score = 2;
    options.split_min_score = 0;
    options.resolve_overlaps = random.Chance(0.5);
    std::vector<Detection> detections;
    for (int k = random.Whole(1, 8); k > 0; --k) {  // best first
      detections.push_back(Rectangle(kCup, 0.1F * static_cast<float>(k), random.Whole(-20, 150),
                                     random.Whole(-20, 120), random.Whole(10, 90),
                                     random.Whole(10, 90)));
    }
    const SegmentedFrame out = Refine(detections, options);
    ExpectConsistent(out);
    splits += out.image.segment_count - 2;
    std::vector<std::vector<int>> inside(detections.size(), std::vector<int>(out.segments.size()));
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        const SegmentIndex segment = out.image.index(v, u);
        if (segment == SegmentIndex::kNone) continue;
        for (size_t k = 0; k < detections.size(); ++k) {
          if (!detections[k].mask.Contains(v, u)) continue;
          ++inside[k][static_cast<size_t>(Raw(segment))];
          if (options.resolve_overlaps) break;
        }
      }
    }
    for (size_t i = 0; i < out.segments.size(); ++i) {
      float best = 0;
      for (size_t k = 0; k < detections.size(); ++k)
        best = std::max(
            best, static_cast<float>(inside[k][i]) / static_cast<float>(out.segments[i].pixels));
      EXPECT_EQ(out.segments[i].overlap, best > static_cast<float>(options.min_overlap) ? best : 0);
      matches += out.segments[i].overlap > 0;
    }
  }
  EXPECT_GT(splits, 50);
  EXPECT_GT(matches, 50);
}

TEST(Refine, AnImageWithoutSegmentsIsValid) {
  DetectionSet set;
  set.detections = {Rectangle(kTable, 0.8F, 0, 0, kWidth, kHeight)};
  const SegmentedFrame out = RefineWithDetections(
      Frame(), {Image<SegmentIndex>(kWidth, kHeight, SegmentIndex::kNone), 0}, &set, {});
  EXPECT_TRUE(out.segments.empty());
}

TEST(Refine, ASegmentImageOfAnotherSizeThrows) {
  EXPECT_THROW(RefineWithDetections(Frame(), {Image<SegmentIndex>(3, 3), 1}, nullptr, {}),
               std::logic_error);
}

}  // namespace
}  // namespace vismap
