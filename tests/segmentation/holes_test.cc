// Holes in the depth, in regular and random patterns, leave the segments as they are without.
#include <gtest/gtest.h>

#include <map>

#include "segmentation/segment_frame.h"
#include "support/analytic_depth.h"
#include "support/hole_patterns.h"

namespace vismap {
namespace {

using testing_support::HolePattern;
using testing_support::HolePatterns;
using testing_support::WithHoles;

/// A floor, a wall, and balls on the floor before it.
Image<float> RoomDepth() {
  TestScene scene;
  scene.planes = {{Eigen::Vector3d(0, 0.94, 0.34), 1.3}, {Eigen::Vector3d(0, -0.34, 0.94), 2.6}};
  for (int i = 0; i < 6; ++i) {
    const double z = 1.3 + 0.12 * i;
    scene.spheres.push_back({Eigen::Vector3d((i - 2.5) * 0.3, 0.25 - 0.1 * (i % 2), z), 0.11});
  }
  return AddNoise(Render(scene).depth, KinectNoise(), 3, 1);
}

SegmentedFrame SegmentDepth(const Image<float>& depth,
                            const SegmentationStageOptions& options = {}) {
  RgbdFrame frame;
  frame.header.camera = kVga;
  frame.depth = depth;
  return SegmentFrame(std::move(frame), nullptr, options);
}

/// The intersection over the union of segment `index` of `a` and the segment of `b` that shares
/// most pixels with it.
double BestOverlap(const SegmentedFrame& a, SegmentIndex index, const SegmentedFrame& b) {
  std::map<SegmentIndex, int> shared;
  for (size_t i = 0; i < a.image.index.size(); ++i) {
    if (a.image.index.data()[i] == index) ++shared[b.image.index.data()[i]];
  }
  shared.erase(SegmentIndex::kNone);
  double best = 0;
  for (const auto& [other, pixels] : shared) {
    const int whole = a.segments[static_cast<size_t>(Raw(index))].pixels +
                      b.segments[static_cast<size_t>(Raw(other))].pixels - pixels;
    best = std::max(best, static_cast<double>(pixels) / whole);
  }
  return best;
}

TEST(SegmentFrame, HolesOfEveryPatternLeaveTheSegmentsAsTheyAre) {
  const SegmentedFrame whole = SegmentDepth(RoomDepth());
  ASSERT_GE(whole.image.segment_count, 8);
  for (const HolePattern& pattern : HolePatterns()) {
    // One pixel in nine does not show the fold between floor and wall.
    if (pattern.name == "eight pixels of nine") continue;
    SCOPED_TRACE(pattern.name);
    const SegmentedFrame punched = SegmentDepth(WithHoles(RoomDepth(), pattern));
    EXPECT_LE(punched.image.segment_count, whole.image.segment_count + 1);
    for (int i = 0; i < whole.image.segment_count; ++i) {
      if (whole.segments[static_cast<size_t>(i)].pixels < 1500) continue;
      EXPECT_GT(BestOverlap(whole, static_cast<SegmentIndex>(i), punched), 0.85)
          << i;  // balls lose rims
    }
  }
}

TEST(SegmentFrame, WithoutFillingRegularHolesLeaveNoSegment) {
  SegmentationStageOptions options;
  options.surface.max_hole_px = 0;
  EXPECT_EQ(
      SegmentDepth(WithHoles(RoomDepth(), HolePatterns().front()), options).image.segment_count, 0);
}

TEST(SegmentFrame, TheDepthOfTheResultHasTheHolesFilled) {
  const Image<float> depth = RoomDepth();
  const SegmentedFrame frame = SegmentDepth(WithHoles(depth, HolePatterns().front()));
  int different = 0;
  for (size_t i = 0; i < depth.size(); ++i) {
    if (!(std::abs(frame.frame.depth.data()[i] - depth.data()[i]) < 0.05F)) ++different;
  }
  EXPECT_LT(different, 0.01 * static_cast<double>(depth.size()));
}

}  // namespace
}  // namespace vismap
