#include "foreign/pose_track.h"

#include <gtest/gtest.h>

#include "foreign/frame_tree.h"
#include "foreign/mount.h"

namespace vismap {
namespace {

using Found = PoseTrack::Found;

Pose Turned(double x, double angle) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, 0, 0);
  pose.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose;
}

TEST(PoseTrack, InterpolatesBetweenTheSamplesAroundATime) {
  PoseTrack track;
  track.Add(1000, Turned(0, 0), 0);
  track.Add(3000, Turned(1, 0.2), 0);
  const PoseTrack::Answer at = track.At(1500, 0, {});
  ASSERT_EQ(at.found, Found::kPose);
  EXPECT_TRUE(at.pose.isApprox(Turned(0.25, 0.05), 1e-12));
  EXPECT_TRUE(track.At(3000, 0, {}).pose.isApprox(Turned(1, 0.2), 1e-12));
}

TEST(PoseTrack, TakesTheNearestSampleWhenTold) {
  PoseTrack track;
  track.Add(1000, Turned(0, 0), 0);
  track.Add(3000, Turned(1, 0.2), 0);
  const PoseLookupOptions nearest{PoseLookup::kNearest, 100'000};
  EXPECT_EQ(track.At(1900, 0, nearest).pose.translation().x(), 0);
  EXPECT_EQ(track.At(2100, 0, nearest).pose.translation().x(), 1);
}

TEST(PoseTrack, WaitsForTheLaterSampleAndRefusesGaps) {
  PoseTrack track;
  track.Add(1000, Turned(0, 0), 0);
  track.Add(2000, Turned(1, 0), 0);
  EXPECT_EQ(track.At(2500, 0, {}).found, Found::kLater);
  EXPECT_EQ(track.At(500, 0, {}).found, Found::kTooOld);
  track.Add(200'000, Turned(2, 0), 0);
  EXPECT_EQ(track.At(2500, 0, {}).found, Found::kGap);
}

TEST(PoseTrack, RestsForNowWhenTold) {
  PoseTrack track;
  track.Add(5000, Turned(1, 1), 0);
  track.Add(6000, Turned(1, 1), 0);
  PoseLookupOptions moving;
  moving.constant_edges = ConstantEdges::kMoving;
  EXPECT_EQ(track.At(5500, 9'000'000, moving).found, Found::kPose);
  EXPECT_EQ(track.At(6500, 9'000'000, moving).found, Found::kLater);
  EXPECT_EQ(track.At(4000, 9'000'000, moving).found, Found::kTooOld);
  EXPECT_EQ(PoseTrack::Fixed(Turned(1, 1)).At(6500, 0, moving).found, Found::kPose);
}

TEST(PoseTrack, IsAMountWhileItDoesNotChange) {
  PoseTrack track;
  track.Add(5000, Turned(1, 1), 0);
  EXPECT_EQ(track.At(1000, 0, {}).found, Found::kLater) << "one sample may be of anything";
  EXPECT_EQ(track.At(1000, 1'000'000, {}).found, Found::kPose) << "for a second";
  track.Add(6000, Turned(1, 1), 0);
  EXPECT_EQ(track.At(1000, 0, {}).found, Found::kPose);
  EXPECT_EQ(track.At(99'000, 0, {}).found, Found::kPose);
  track.Add(7000, Turned(1.1, 1), 0);
  EXPECT_EQ(track.At(99'000, 0, {}).found, Found::kLater);
}

TEST(PoseTrack, ForgetsWhatWasBeforeAStepBackInTime) {
  PoseTrack track;
  track.Add(100'000'000, Turned(0, 0), 0);
  track.Add(100'100'000, Turned(1, 0), 0);
  track.Add(0, Turned(5, 0), 0);
  track.Add(1000, Turned(6, 0), 0);
  EXPECT_NEAR(track.At(500, 0, {}).pose.translation().x(), 5.5, 1e-12);
}

TEST(PoseTrack, SortsSamplesThatComeLate) {
  PoseTrack track;
  track.Add(3000, Turned(3, 0), 0);
  track.Add(1000, Turned(1, 0), 0);
  track.Add(2000, Turned(2, 0), 0);
  EXPECT_NEAR(track.At(1500, 0, {}).pose.translation().x(), 1.5, 1e-12);
}

TEST(FrameTree, ComposesAcrossBranches) {
  FrameTree tree{{}};
  tree.AddMount("base", "camera", Turned(1, 0));
  tree.AddMount("base", "lidar", Turned(0, M_PI / 2));
  tree.Add({"world", "base", 0, Turned(0, 0)}, 0);
  tree.Add({"world", "base", 1000, Turned(10, 0)}, 0);
  EXPECT_TRUE(tree.Find("world", "camera", 500, 0).pose.isApprox(Turned(6, 0), 1e-12));
  EXPECT_TRUE(tree.Find("camera", "world", 500, 0).pose.isApprox(Turned(-6, 0), 1e-12));
  const Pose expected = Turned(0, M_PI / 2).inverse() * Turned(1, 0);
  EXPECT_TRUE(tree.Find("lidar", "camera", 99, 0).pose.isApprox(expected, 1e-12));
}

TEST(FrameTree, SaysWhichFramesAreKnownWhenNoPathExists) {
  FrameTree tree{{}};
  tree.AddMount("base", "camera", Turned(1, 0));
  const FrameTree::Answer answer = tree.Find("world", "camera", 0, 0);
  EXPECT_EQ(answer.state, FrameTree::State::kWaiting);
  EXPECT_NE(answer.why.find("'camera' with 'world'"), std::string::npos) << answer.why;
}

TEST(FrameTree, SurvivesACircle) {
  FrameTree tree{{}};
  tree.AddMount("a", "b", Turned(1, 0));
  tree.AddMount("b", "a", Turned(1, 0));
  EXPECT_EQ(tree.Find("world", "a", 0, 0).state, FrameTree::State::kWaiting);
}

TEST(Mount, IsParsedWithItsFrames) {
  const Result<Mount> mount = ParseMount("base camera 1 -2 0.5 0 1 0 0");
  ASSERT_TRUE(mount) << mount.error().message;
  EXPECT_EQ(mount->parent, "base");
  EXPECT_EQ(mount->child, "camera");
  EXPECT_TRUE(mount->T_parent_child.translation().isApprox(Eigen::Vector3d(1, -2, 0.5)));
  EXPECT_NEAR(mount->T_parent_child(1, 1), -1, 1e-12) << "half a turn about x";
}

TEST(Mount, MustBeWhole) {
  for (const char* text :
       {"", "base", "base camera 1 2 3", "base camera 1 2 3 1 0 0", "base camera 1 2 3 1 0 0 0 9",
        "base camera 1 2 3 2 0 0 0", "base camera 1 2 x 1 0 0 0"})
    EXPECT_FALSE(ParseMount(text)) << text;
}

}  // namespace
}  // namespace vismap
