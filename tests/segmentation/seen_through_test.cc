#include "segmentation/seen_through.h"

#include <gtest/gtest.h>

#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

TEST(MeanDepths, AreThoseOfThePixelsOfEachSegment) {
  SegmentedFrame frame{Frame(), Halves(), {{.pixels = 100 * 140}, {.pixels = 100 * 140}}, true};
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < 50; ++u) frame.frame.depth(v, u) = 3.0F;
  }
  const std::vector<double> depths = MeanDepths(frame);
  ASSERT_EQ(depths.size(), 2u);
  EXPECT_NEAR(depths[0], 2.0, 1e-9);
  EXPECT_NEAR(depths[1], 1.0, 1e-9);
}

TEST(LargestSegments, AreTheFirstOfTheLargestOfEachDetection) {
  const std::vector<FrameSegment> segments{{.pixels = 5, .detection = DetectionIndex{2}},
                                           {.pixels = 9, .detection = DetectionIndex{2}},
                                           {.pixels = 9, .detection = DetectionIndex{2}},
                                           {.pixels = 50},
                                           {.pixels = 1, .detection = DetectionIndex{0}}};
  EXPECT_EQ(LargestSegments(segments, 3),
            (std::vector<SegmentIndex>{SegmentIndex{4}, SegmentIndex::kNone, SegmentIndex{1}}));
}

TEST(IsWithinExtent, ComparesWithTheLargerSideOfTheMask) {
  const PinholeCamera camera = Frame().header.camera;  // 200 px focal length
  const Mask mask = Rectangle(kChair, 1, 0, 0, 50, 100).mask;
  // At 2 m the mask is 0.5 m wide and 1 m high.
  EXPECT_TRUE(IsWithinExtent(2.99, 2, mask, camera, 1));
  EXPECT_FALSE(IsWithinExtent(3.01, 2, mask, camera, 1));
  EXPECT_TRUE(IsWithinExtent(1.01, 2, mask, camera, 1));
  EXPECT_FALSE(IsWithinExtent(0.99, 2, mask, camera, 1));
  EXPECT_TRUE(IsWithinExtent(3.49, 2, mask, camera, 1.5));
  EXPECT_TRUE(IsWithinExtent(100, 2, mask, camera, 0));
}

TEST(DropSeenThrough, OnlySegmentsAtTheObjectsDepthKeepItsDetection) {
  const DetectionSet set = Set({Rectangle(kChair, 0.9F, 0, 0, 100, 100)});
  const PixelOwnership ownership(set, {}, kWidth, kHeight);
  SegmentedFrame frame;
  frame.frame = Frame();
  const FrameSegment chair{10, DetectionIndex{0}, kChair, 0.9F, 1.0F};
  frame.segments = {chair, chair, {.pixels = 7}};
  frame.segments[1].pixels = 90;
  // The mask has sides of 0.5 m at the depth of segment 1, 1 m.
  const std::vector<FrameSegment> kept = DropSeenThrough(frame, ownership, {1.4, 1, 5}, 1);
  EXPECT_TRUE(kept == frame.segments);
  const std::vector<FrameSegment> dropped = DropSeenThrough(frame, ownership, {1.6, 1, 5}, 1);
  EXPECT_EQ(dropped[0], (FrameSegment{.pixels = 10}));
  EXPECT_EQ(dropped[1], frame.segments[1]);
}

}  // namespace
}  // namespace vismap
