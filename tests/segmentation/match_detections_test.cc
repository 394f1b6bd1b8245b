#include "segmentation/match_detections.h"

#include <gtest/gtest.h>

#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

/// Segments of 100 and 200 pixels against two detections, of which the second one is better.
std::vector<FrameSegment> Match(const std::vector<std::vector<int32_t>>& inside) {
  static const DetectionSet set =
      Set({Rectangle(kTable, 0.6F, 0, 0, 9, 9), Rectangle(kChair, 0.8F, 50, 0, 9, 9)});
  static const PixelOwnership ownership(set, {}, kWidth, kHeight);
  SegmentCounts counts;
  counts.pixels = {100, 200};
  counts.inside = inside;
  return MatchDetections(counts, ownership, 0.7);
}

TEST(MatchDetections, ASegmentGetsTheDetectionThatOwnsMostOfIt) {
  const std::vector<FrameSegment> segments = Match({{80, 0}, {0, 180}});
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_EQ(segments[0], (FrameSegment{100, DetectionIndex{1}, kChair, 0.8F, 0.8F}));
  EXPECT_EQ(segments[1], (FrameSegment{200, DetectionIndex{0}, kTable, 0.6F, 0.9F}));
}

TEST(MatchDetections, ThePartMustExceedTheLimit) {
  EXPECT_EQ(Match({{70, 141}, {}})[0].detection, DetectionIndex::kNone);
  EXPECT_EQ(Match({{71, 141}, {}})[0].detection, DetectionIndex{1});
  EXPECT_EQ(Match({{71, 141}, {}})[1].detection, DetectionIndex{1});
}

TEST(MatchDetections, OfEqualPartsTheBetterDetectionWins) {
  EXPECT_EQ(Match({{80, 0}, {80, 0}})[0].detection, DetectionIndex{1});
  EXPECT_EQ(Match({{80, 0}, {81, 0}})[0].detection, DetectionIndex{0});
}

TEST(MatchDetections, RowsMayEndBeforeTheLastSegment) {
  const std::vector<FrameSegment> segments = Match({{80}, {}});
  EXPECT_EQ(segments[0].detection, DetectionIndex{1});
  EXPECT_EQ(segments[1], (FrameSegment{.pixels = 200}));
}

}  // namespace
}  // namespace vismap
