#include "geometry/prepare_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace vismap {
namespace {

TEST(PrepareDepth, DepthOutsideOfTheLimitsIsNoReturn) {
  Image<float> depth(40, 40, 2.0F);
  depth(3, 3) = 12.0F;
  depth(3, 4) = 0.05F;
  depth(3, 5) = std::numeric_limits<float>::infinity();
  depth(3, 6) = 10.0F;
  depth(3, 7) = 0.1F;
  PrepareDepthOptions options;
  options.holes.max_px = 0;
  PrepareDepth(options, &depth);
  for (const int u : {3, 4, 5}) EXPECT_TRUE(std::isnan(depth(3, u))) << u;
  EXPECT_EQ(depth(3, 6), 10.0F);
  EXPECT_EQ(depth(3, 7), 0.1F);
  EXPECT_EQ(depth(20, 20), 2.0F);
}

TEST(PrepareDepth, SmallHolesOfFarDepthAreFilled) {
  Image<float> depth(40, 40, 2.0F);
  depth(20, 20) = 12.0F;
  PrepareDepth({}, &depth);
  EXPECT_NEAR(depth(20, 20), 2.0, 1e-4);
}

TEST(PrepareDepth, TheOptionsOfTheSurfaceDecide) {
  SurfaceOptions surface;
  surface.min_depth_m = 0.5;
  surface.max_depth_m = 1.5;
  Image<float> depth(40, 40, 2.0F);
  for (int u = 0; u < 20; ++u) depth(5, u) = 1.0F;
  PrepareDepth(PrepareDepthOptionsOf(surface), &depth);
  EXPECT_TRUE(std::isnan(depth(20, 20)));
  EXPECT_EQ(depth(5, 5), 1.0F);
}

TEST(PrepareDepth, KeepsTheMeasuredDepthOfAFrameOnlyWhenSomeIsTakenOut) {
  RgbdFrame frame;
  frame.depth = Image<float>(40, 40, 2.0F);
  frame.depth(20, 20) = std::nanf("");
  PrepareDepth({}, &frame);
  EXPECT_TRUE(frame.measured_depth.empty());
  EXPECT_NEAR(frame.depth(20, 20), 2.0, 1e-4);
  frame.depth(3, 3) = 12.0F;
  PrepareDepth({}, &frame);
  ASSERT_FALSE(frame.measured_depth.empty());
  EXPECT_EQ(frame.measured_depth(3, 3), 12.0F);
  EXPECT_NEAR(frame.depth(3, 3), 2.0, 1e-4);
}

}  // namespace
}  // namespace vismap
