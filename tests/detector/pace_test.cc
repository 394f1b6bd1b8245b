#include "detector/pace.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

TEST(Pace, SummarizesTheFramesSinceTheLastCall) {
  Pace pace(100);
  EXPECT_FALSE(pace.Summarize(110)) << "there were no frames";
  for (int i = 0; i < 48; ++i) pace.AddProcessed(147);
  for (int i = 0; i < 252; ++i) pace.AddSkipped();
  EXPECT_EQ(pace.Summarize(120),
            "runs on 4.8 of 30.0 frames per second, 147 ms per frame (median)");
  EXPECT_FALSE(pace.Summarize(130));
}

}  // namespace
}  // namespace vismap
