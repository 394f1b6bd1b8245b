#include "plausibility/depth_losses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(DepthLosses, UpToFivePercentAreNotTold) {
  const DepthLosses losses{
      .frames = 1, .pixels = 1000, .too_near = 50, .too_far = 50, .saturated = 50};
  EXPECT_THAT(FindingsOf(losses, {}), IsEmpty());
  EXPECT_THAT(FindingsOf({}, {}), IsEmpty());
}

TEST(DepthLosses, MoreAreToldWithTheLikelyCauseAndTheKey) {
  DepthLosses losses{.frames = 1, .pixels = 1000, .saturated = 100, .saturated_m = 8};
  EXPECT_THAT(FindingsOf(losses, {}),
              ElementsAre(testing::AllOf(HasSubstr("10 % of the pixels have exactly the same "
                                                   "depth, 8 m"),
                                         HasSubstr("glass"), HasSubstr("drop_saturated"))));
  losses.saturated = 0;
  losses.too_far = 60;
  losses.too_near = 70;
  EXPECT_THAT(
      FindingsOf(losses, {}),
      ElementsAre(testing::AllOf(HasSubstr("6 %"), HasSubstr("10 m"), HasSubstr("max_depth_m")),
                  testing::AllOf(HasSubstr("7 %"), HasSubstr("0.1 m"), HasSubstr("min_depth_m"))));
}

TEST(DepthLosses, AreAdded) {
  DepthLosses sum{
      .frames = 1, .pixels = 10, .too_near = 1, .too_far = 2, .saturated = 3, .saturated_m = 8};
  sum.Add({.frames = 1, .pixels = 10, .too_near = 1, .too_far = 1});
  EXPECT_EQ(sum.frames, 2);
  EXPECT_EQ(sum.pixels, 20);
  EXPECT_EQ(sum.too_near, 2);
  EXPECT_EQ(sum.too_far, 3);
  EXPECT_EQ(sum.saturated, 3);
  EXPECT_EQ(sum.saturated_m, 8);
}

}  // namespace
}  // namespace vismap
