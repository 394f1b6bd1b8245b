#include "plausibility/depth_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace vismap {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

SegmentedFrame FrameOf(const std::function<float(int, int)>& depth, SegmentIndex segment) {
  SegmentedFrame frame;
  frame.frame.depth = Image<float>(160, 120);
  frame.image.index = Image<SegmentIndex>(160, 120, segment);
  for (int v = 0; v < 120; ++v) {
    for (int u = 0; u < 160; ++u) frame.frame.depth(v, u) = depth(v, u);
  }
  return frame;
}

TEST(DepthCheck, SaysNothingAboutAGoodFrame) {
  DepthCheck check({0.1, 5});
  check.Add(FrameOf([](int, int) { return 2.0F; }, SegmentIndex{0}));
  EXPECT_NEAR(check.median(), 2, 0.06);
  EXPECT_EQ(check.share_in_segments(), 1);
  EXPECT_EQ(check.RangeFinding(0.001), std::nullopt);
  EXPECT_EQ(check.SegmentFinding(), std::nullopt);
}

TEST(DepthCheck, AWrongUnitIsToldWithTheMedianAndTheUnit) {
  DepthCheck check({0.1, 5});
  check.Add(FrameOf([](int, int) { return 20.0F; }, SegmentIndex{0}));
  EXPECT_THAT(check.RangeFinding(0.01),
              Optional(::testing::AllOf(::testing::ContainsRegex("median is (19|20)"),
                                        HasSubstr("0.01 m per step"))));
}

TEST(DepthCheck, NearlyNoDepthIsTold) {
  DepthCheck check({0.1, 5});
  check.Add(FrameOf([](int, int) { return kNone; }, SegmentIndex{0}));
  EXPECT_THAT(check.RangeFinding(0.001), Optional(HasSubstr("0 % of the pixels")));
}

TEST(DepthCheck, HolesAreNamedAsTheCauseOfMissingSegments) {
  for (const int period : {2, 3, 4, 5}) {
    DepthCheck check({0.1, 5});
    for (int i = 0; i < 8; ++i) {
      check.Add(FrameOf([&](int v, int u) { return v % period && u % period ? 1.0F : kNone; },
                        SegmentIndex::kNone));
    }
    EXPECT_THAT(check.SegmentFinding(), Optional(HasSubstr("beside a hole"))) << period;
  }
  DepthCheck check({0.1, 5});
  check.Add(FrameOf([](int, int) { return 1.0F; }, SegmentIndex::kNone));
  EXPECT_THAT(check.SegmentFinding(), Optional(HasSubstr("noisier")));
}

}  // namespace
}  // namespace vismap
