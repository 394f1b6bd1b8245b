#include "map/far_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismap {
namespace {

using ::testing::HasSubstr;

void AddFrames(int count, const Eigen::Vector3d& at, std::vector<CameraPose>* trajectory) {
  for (int i = 0; i < count; ++i) {
    CameraPose pose;
    pose.T_W_C.translation() = at + Eigen::Vector3d(0.01 * i, 0, 0);
    trajectory->push_back(pose);
  }
}

TEST(FarParts, AreThoseOfFewFramesFarAway) {
  std::vector<CameraPose> trajectory;
  AddFrames(50, {1, 1, 1}, &trajectory);
  AddFrames(2, {2000, 0, 0}, &trajectory);
  const FarParts far(trajectory);
  EXPECT_EQ(far.frames(), 2);
  EXPECT_TRUE(far.Contains({2003, -1, 4}));
  EXPECT_FALSE(far.Contains({2003, -1, 60}));
  EXPECT_FALSE(far.Contains({3, 0, 0}));
  EXPECT_THAT(*far.Sentence(), HasSubstr("2 of 52 frames"));
}

TEST(FarParts, AnOrdinaryMapHasNone) {
  std::vector<CameraPose> trajectory;
  for (int i = 0; i < 100; ++i) AddFrames(1, {15.0 * i, 3, 0}, &trajectory);
  EXPECT_TRUE(FarParts(trajectory).empty()) << "a way through a long building";
  AddFrames(30, {0, 500, 0}, &trajectory);
  EXPECT_TRUE(FarParts(trajectory).empty()) << "a second building";
  EXPECT_FALSE(FarParts(trajectory).Sentence());
  EXPECT_TRUE(FarParts(std::vector<CameraPose>()).empty());
}

TEST(FarParts, AFewFramesAreNotJudgedAgainstAsFew) {
  std::vector<CameraPose> trajectory;
  AddFrames(2, {2000, 0, 0}, &trajectory);
  EXPECT_TRUE(FarParts(trajectory).empty());
  AddFrames(3, {0, 0, 0}, &trajectory);
  EXPECT_TRUE(FarParts(trajectory).empty());
  AddFrames(2, {0, 0, 0}, &trajectory);
  EXPECT_EQ(FarParts(trajectory).frames(), 2);
}

TEST(FarParts, CubesBetweenTwoPartsBelongToTheLargerOne) {
  std::vector<CameraPose> trajectory;
  AddFrames(50, {10, 10, 10}, &trajectory);
  AddFrames(1, {50, 10, 10}, &trajectory);
  const FarParts far(trajectory);
  EXPECT_TRUE(far.Contains({50, 10, 10}));
  EXPECT_FALSE(far.Contains({30, 10, 10}));
}

}  // namespace
}  // namespace vismap
