#include "map_server/camera_clocks.h"

#include <gtest/gtest.h>

#include <limits>

#include "map_server/small_frames.h"

namespace vismap {
namespace {

using testing_support::Key;

TEST(CameraClocks, ReportFramesOutOfOrderAndJumpsPerCamera) {
  CameraClocks clocks;
  EXPECT_FALSE(clocks.Check(Key(0, 1'000'000)));
  EXPECT_FALSE(clocks.Check(Key(0, 1'033'000)));
  EXPECT_FALSE(clocks.Check(Key(1, 5))) << "another camera has its own clock";
  EXPECT_TRUE(clocks.Check(Key(0, 1'020'000)));
  EXPECT_EQ(clocks.out_of_order(), 1);
  EXPECT_EQ(clocks.jumps(), 0);
  EXPECT_TRUE(clocks.Check(Key(0, 1'020'000 + CameraClocks::kLargestStep + 1)));
  EXPECT_EQ(clocks.jumps(), 1);
  EXPECT_TRUE(clocks.Check(Key(0, 1'020'000)));
  EXPECT_EQ(clocks.jumps(), 2);
  EXPECT_EQ(clocks.out_of_order(), 2);
}

TEST(CameraClocks, AnyTwoTimesCanBeCompared) {
  CameraClocks clocks;
  clocks.Check(Key(0, std::numeric_limits<int64_t>::min()));
  EXPECT_TRUE(clocks.Check(Key(0, std::numeric_limits<int64_t>::max())));
  EXPECT_TRUE(clocks.Check(Key(0, std::numeric_limits<int64_t>::min())));
  EXPECT_EQ(clocks.jumps(), 2);
}

}  // namespace
}  // namespace vismap
