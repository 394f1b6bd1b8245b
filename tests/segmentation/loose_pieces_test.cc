#include "segmentation/loose_pieces.h"

#include <gtest/gtest.h>

#include "support/refine_frames.h"

namespace vismap {
namespace {

using namespace testing_support;

constexpr SegmentIndex kLeft{0}, kRight{1};

/// The left half is a chair. A loose piece of 10 x 4 pixels lies in the right half, which has no
/// detection, with `first` as its first column.
SegmentedFrame FrameWithPiece(int first) {
  SegmentedFrame frame{Frame(), Halves(), {{.pixels = 100 * 140}, {.pixels = 100 * 140}}, true};
  frame.segments[0].detection = DetectionIndex{0};
  for (int v = 50; v < 54; ++v) frame.image.loose.push_back({v, first, first + 10, 0});
  return frame;
}

SegmentedFrame Attach(SegmentedFrame frame, const DetectionSet& set) {
  const RefineOptions options;
  const PixelOwnership ownership(set, options, kWidth, kHeight);
  return AttachLoosePieces(std::move(frame), ownership, {1.0, 1.0}, options);
}

TEST(AttachLoosePieces, APieceGoesToTheSegmentOfTheMaskThatCoversIt) {
  const DetectionSet set = Set({Rectangle(kChair, 0.9F, 0, 0, 128, kHeight)});
  const SegmentedFrame covered = Attach(FrameWithPiece(120), set);  // 8 of its 10 columns
  EXPECT_EQ(covered.image.index(50, 120), kLeft);
  EXPECT_EQ(covered.image.index(53, 129), kLeft);
  EXPECT_EQ(covered.image.index(50, 119), kRight);
  EXPECT_EQ(covered.segments[0].pixels, 100 * 140 + 40);
  EXPECT_EQ(covered.segments[1].pixels, 100 * 140 - 40);
  const SegmentedFrame outside = Attach(FrameWithPiece(121), set);  // 7 of 10 columns
  EXPECT_EQ(outside.image.index(50, 121), kRight);
}

TEST(AttachLoosePieces, APieceOfADetectedSegmentStays) {
  const DetectionSet set = Set(
      {Rectangle(kChair, 0.9F, 0, 0, 150, kHeight), Rectangle(kTable, 0.5F, 150, 0, 50, kHeight)});
  SegmentedFrame frame = FrameWithPiece(120);
  frame.segments[1].detection = DetectionIndex{1};
  EXPECT_EQ(Attach(std::move(frame), set).image.index(50, 120), kRight);
}

TEST(AttachLoosePieces, ADetectionWithoutSegmentGetsNoPiece) {
  const DetectionSet set = Set(
      {Rectangle(kChair, 0.5F, 0, 0, 100, kHeight), Rectangle(kTable, 0.9F, 100, 0, 90, kHeight)});
  EXPECT_EQ(Attach(FrameWithPiece(120), set).image.index(50, 120), kRight);
}

TEST(AttachLoosePieces, APieceOfNoSegmentIsAttachedToo) {
  SegmentedFrame frame = FrameWithPiece(120);
  for (const LooseRun& run : frame.image.loose) {
    for (int u = run.begin; u < run.end; ++u) {
      frame.image.index(run.v, u) = SegmentIndex::kNone;
      --frame.segments[1].pixels;
    }
  }
  const SegmentedFrame out =
      Attach(std::move(frame), Set({Rectangle(kChair, 0.9F, 0, 0, 150, kHeight)}));
  EXPECT_EQ(out.image.index(53, 129), kLeft);
  EXPECT_EQ(out.segments[0].pixels, 100 * 140 + 40);
  EXPECT_EQ(out.segments[1].pixels, 100 * 140 - 40);
}

}  // namespace
}  // namespace vismap
