#include "detector/pace.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

TEST(Pace, SaysWhatCameSinceItWasAsked) {
  Pace pace(100);
  EXPECT_FALSE(pace.Take(110)) << "no frames, nothing to say";
  for (int i = 0; i < 48; ++i) pace.Looked(147);
  for (int i = 0; i < 252; ++i) pace.PassedOver();
  EXPECT_EQ(pace.Take(120), "looks at 4.8 of 30.0 frames per second, median 147 ms each");
  EXPECT_FALSE(pace.Take(130));
}

}  // namespace
}  // namespace vismap
