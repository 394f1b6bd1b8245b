#include "segmentation/fold_pixels.h"

#include <gtest/gtest.h>

#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

/// The left half, of which the mask reaches 10 columns into the right half, with a fold on the
/// columns 94 to 104 along the border between the two.
SegmentedFrame FrameWithFold() {
  SegmentedFrame frame{Frame(), Halves(), {{.pixels = 100 * 140}, {.pixels = 100 * 140}}, true};
  frame.segments[0].detection = DetectionIndex{0};
  frame.image.edge_strength = Image<uint8_t>(kWidth, kHeight);
  for (int v = 10; v < kHeight; ++v) {
    for (int u = 94; u < 105; ++u) frame.image.edge_strength(v, u) = 50;
  }
  return frame;
}

/// Columns of row 80 that moved from the right half to the left.
int MovedColumns(SegmentedFrame frame, float score = 0.9F) {
  const DetectionSet set = Set({Rectangle(kChair, score, 0, 0, 110, kHeight)});
  const PixelOwnership ownership(set, {}, kWidth, kHeight);
  const SegmentedFrame out = AssignFoldPixels(std::move(frame), ownership, 0.5);
  int moved = 0;
  for (int u = 100; u < kWidth; ++u) moved += out.image.index(80, u) == SegmentIndex{0} ? 1 : 0;
  EXPECT_EQ(out.segments[0].pixels + out.segments[1].pixels, 200 * 140);
  return moved;
}

TEST(AssignFoldPixels, FoldPixelsInTheMaskMoveAndNoOthersDo) {
  EXPECT_EQ(MovedColumns(FrameWithFold()), 5);
  EXPECT_EQ(MovedColumns(FrameWithFold(), 0.4F), 0);
}

TEST(AssignFoldPixels, PixelsBesideADepthJumpAreOnNoFold) {
  SegmentedFrame frame = FrameWithFold();
  for (int v = 10; v < kHeight; ++v) frame.image.edge_strength(v, 102) = kBesideJump;
  EXPECT_EQ(MovedColumns(std::move(frame)), 2);
}

TEST(AssignFoldPixels, GrowthStopsAtADepthJump) {
  SegmentedFrame frame = FrameWithFold();
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 103; u < kWidth; ++u) frame.frame.depth(v, u) = 1.03F;
  }
  EXPECT_EQ(MovedColumns(std::move(frame)), 3);
}

TEST(AssignFoldPixels, PixelsOfOtherObjectsStay) {
  SegmentedFrame frame = FrameWithFold();
  frame.segments[1].detection = DetectionIndex{7};
  EXPECT_EQ(MovedColumns(std::move(frame)), 0);
}

}  // namespace
}  // namespace vismap
