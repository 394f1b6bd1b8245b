#include "plausibility/camera_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(UnusualCamera, SaysNothingAboutUsualOnes) {
  EXPECT_THAT(UnusualCamera({640, 480, 525, 525, 319.5, 239.5}), IsEmpty());
  EXPECT_THAT(UnusualCamera({1280, 720, 900, 900, 639.5, 359.5}), IsEmpty());
  EXPECT_THAT(UnusualCamera({848, 480, 424, 424, 420, 238}), IsEmpty());       // 90 degrees
  EXPECT_THAT(UnusualCamera({640, 480, 525, -525, 319.5, 239.5}), IsEmpty());  // ICL's
  EXPECT_THAT(UnusualCamera({1920, 256, 2000, 2000, 960, 128}), IsEmpty());    // a wide strip
}

TEST(UnusualCamera, NamesTheAngleOfView) {
  EXPECT_THAT(UnusualCamera({1280, 720, 140, 140, 639.5, 359.5}),
              ElementsAre(HasSubstr("fx = 140"), HasSubstr("fy = 140")));
  EXPECT_THAT(UnusualCamera({160, 120, 525, 525, 79.5, 59.5}),
              ElementsAre(HasSubstr("17.3 degrees")));
}

TEST(UnusualCamera, NamesThePrincipalPoint) {
  EXPECT_THAT(UnusualCamera({1280, 720, 900, 900, 319.5, 359.5}),
              ElementsAre(HasSubstr("cx = 319.5")));
  EXPECT_THAT(UnusualCamera({640, 480, 525, 525, 319.5, 400}), ElementsAre(HasSubstr("cy = 400")));
}

}  // namespace
}  // namespace vismap
