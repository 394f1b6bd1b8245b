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

// A simulation that begins again after six seconds, ten poses per second.
TEST(PoseTrack, ForgetsTheRunBeforeWhenTimeJumpsBackByLessThanWhatIsKept) {
  PoseTrack track;
  int64_t received = 0;
  const auto run = [&](double x, int64_t samples) {
    for (int64_t i = 0; i < samples; ++i)
      EXPECT_TRUE(track.Add(100'000 * i, Turned(x + 1e-3 * static_cast<double>(i), 0),
                            received += 100'000));
  };
  run(0, 60);
  EXPECT_EQ(track.At(3'050'000, received, {}).found, Found::kPose);
  run(50, 2);
  EXPECT_EQ(track.size(), 2u);
  EXPECT_EQ(track.At(3'050'000, received, {}).found, Found::kLater) << "it has not been yet";
  EXPECT_NEAR(track.At(50'000, received, {}).pose.translation().x(), 50, 0.01);
}

// A SLAM that has closed a loop sends the poses of its last three seconds again, 1 m to the side.
TEST(PoseTrack, KeepsWhatIsOlderThanPosesThatAreSentAgain) {
  PoseTrack track;
  const auto send = [&](int64_t from, int64_t to, double side, int64_t received) {
    for (int64_t utime = from; utime < to; utime += 100'000)
      track.Add(utime, Turned(side + 1e-6 * static_cast<double>(utime), 0), received);
  };
  const auto x_at = [&](int64_t utime) {
    const PoseTrack::Answer answer = track.At(utime, 8'000'000, {});
    EXPECT_EQ(answer.found, Found::kPose) << utime;
    return answer.pose.translation().x();
  };
  for (int64_t utime = 0; utime < 8'000'000; utime += 100'000) send(utime, utime + 1, 0, utime);
  EXPECT_NEAR(x_at(6'050'000), 6.05, 1e-9);
  send(5'000'000, 5'200'000, 1, 8'000'000);
  EXPECT_EQ(track.At(6'050'000, 8'000'000, {}).found, Found::kLater) << "it comes again";
  send(5'200'000, 8'000'000, 1, 8'000'000);
  EXPECT_NEAR(x_at(6'050'000), 7.05, 1e-9);
  EXPECT_NEAR(x_at(4'850'000), 4.85, 1e-9) << "an image that came late";
  EXPECT_EQ(track.At(4'950'000, 8'000'000, {}).found, Found::kGap) << "between old and new poses";
  send(8'000'000, 8'200'000, 1, 8'100'000);
  EXPECT_NEAR(x_at(8'050'000), 9.05, 1e-9);
}

TEST(PoseTrack, SingleSamplesOfWrongTimesMakeItForgetNothing) {
  for (const int64_t wrong : {-5'000'000, 5'000'000}) {
    PoseTrack track;
    for (int64_t i = 0; i < 100; ++i) {
      const int64_t utime = 20'000'000 + 100'000 * i;
      const bool is_wrong = i == 40 || i == 60;
      track.Add(is_wrong ? utime + wrong : utime, Turned(1e-3 * static_cast<double>(i), 0), utime);
    }
    EXPECT_EQ(track.At(29'850'000 - 8'000'000, 30'000'000, {}).found, Found::kPose)
        << "what came before is still known, wrong by " << wrong;
  }
}

TEST(PoseTrack, ADelayedCopyOfTheStreamIsNoStepBack) {
  PoseTrack track;
  for (int64_t i = 0; i < 100; ++i) {
    track.Add(20'000'000 + 100'000 * i, Turned(1e-3 * static_cast<double>(i), 0), 0);
    if (i >= 20)
      track.Add(18'000'000 + 100'000 * i, Turned(1e-3 * static_cast<double>(i - 20), 0), 0);
  }
  EXPECT_EQ(track.At(21'050'000, 0, {}).found, Found::kPose);
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

// A joint that first rests and then moves.
TEST(PoseTrack, HoldsItsFirstPoseUpToTheLastSampleThatHadIt) {
  PoseTrack joint;
  for (int64_t second = 1; second <= 30; ++second)
    joint.Add(second * 1'000'000, Turned(1, 0), second * 1'000'000);
  EXPECT_EQ(joint.At(30'400'000, 30'400'000, {}).found, Found::kPose) << "a mount up to now";
  joint.Add(30'500'000, Turned(2, 0), 30'500'000);
  joint.Add(30'550'000, Turned(3, 0), 30'550'000);
  for (const int64_t utime : {0, 1'500'000, 29'500'000, 30'000'000}) {
    const PoseTrack::Answer rest = joint.At(utime, 31'000'000, {});
    ASSERT_EQ(rest.found, Found::kPose) << utime;
    EXPECT_EQ(rest.pose.translation().x(), 1) << utime;
  }
  EXPECT_EQ(joint.At(30'200'000, 31'000'000, {}).found, Found::kGap) << "when did it start?";
  EXPECT_NEAR(joint.At(30'525'000, 31'000'000, {}).pose.translation().x(), 2.5, 1e-12);
  EXPECT_EQ(joint.At(30'600'000, 31'000'000, {}).found, Found::kLater);
  joint.Add(30'600'000, Turned(1, 0), 30'600'000);
  joint.Add(31'600'000, Turned(1, 0), 31'600'000);
  EXPECT_EQ(joint.At(31'000'000, 32'000'000, {}).found, Found::kGap) << "it is no mount any more";
  joint.Add(29'800'000, Turned(4, 0), 32'000'000);  // comes late
  EXPECT_EQ(joint.At(29'000'000, 33'000'000, {}).pose.translation().x(), 1);
  EXPECT_EQ(joint.At(29'900'000, 33'000'000, {}).found, Found::kGap);
  EXPECT_EQ(joint.At(30'000'000, 33'000'000, {}).pose.translation().x(), 1);
}

TEST(PoseTrack, InterpolatesFromTheRestToTheFirstMove) {
  PoseTrack joint;
  for (int64_t utime = 0; utime <= 60'000; utime += 20'000) joint.Add(utime, Turned(1, 0), utime);
  joint.Add(80'000, Turned(2, 0), 80'000);
  EXPECT_EQ(joint.At(50'000, 80'000, {}).pose.translation().x(), 1);
  EXPECT_NEAR(joint.At(70'000, 80'000, {}).pose.translation().x(), 1.5, 1e-12);
}

TEST(PoseTrack, OneSampleBeforeAMoveIsNoRest) {
  PoseTrack track;
  track.Add(1000, Turned(1, 0), 0);
  track.Add(2000, Turned(2, 0), 0);
  EXPECT_EQ(track.At(500, 0, {}).found, Found::kTooOld);
}

TEST(PoseTrack, LosesNothingButASampleWithAWrongTime) {
  for (const int64_t wrong : {int64_t{0}, int64_t{500'000'000'000}}) {
    PoseTrack track;
    bool all_right = true;
    for (int i = 0; i < 10; ++i) {
      const int64_t utime = 100'000'000 + i * 20'000;
      all_right &= track.Add(i == 5 ? wrong : utime, Turned(i, 0), utime);
    }
    EXPECT_FALSE(all_right);
    EXPECT_EQ(track.size(), 9u);
    EXPECT_NEAR(track.At(100'090'000, 0, {}).pose.translation().x(), 4.5, 1e-12);
    EXPECT_NEAR(track.At(100'110'000, 0, {}).pose.translation().x(), 5.5, 1e-12);
  }
}

TEST(PoseTrack, KeepsTheNewestSamples) {
  PoseTrack track;
  for (int i = 0; i < 100; ++i) track.Add(i * 100'000, Turned(i, 0), i * 100'000);
  EXPECT_EQ(track.KeepNewest(50), 0u) << "the oldest five seconds";
  EXPECT_EQ(track.KeepNewest(15), 5u) << "of the newest two seconds";
  EXPECT_EQ(track.size(), 15u);
  EXPECT_EQ(track.At(9'850'000, 0, {}).found, Found::kPose);
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

TEST(FrameTree, BoundsTheSamplesOfAllFramesAndSaysWhatItLeavesOut) {
  FrameTree tree{{}};
  tree.AddMount("base", "camera", Turned(1, 0));
  std::string early, too_many;
  for (int frame = 0; frame < 4200; ++frame) {
    for (int i = 0; i < 150; ++i) {
      const std::string told =
          tree.Add({"world", "frame" + std::to_string(frame), i * 10'000, Turned(i, 0)}, 0);
      if (!told.empty()) (frame < 4000 ? early : too_many) = told;
    }
  }
  EXPECT_LE(tree.size(), 400'000u);
  EXPECT_GT(tree.size(), 380'000u);
  EXPECT_NE(early.find("forgotten early"), std::string::npos) << early;
  EXPECT_NE(too_many.find("4096 frames have poses already"), std::string::npos) << too_many;
  EXPECT_EQ(tree.Find("world", "frame7", 1'485'000, 0).state, FrameTree::State::kFound);
  EXPECT_EQ(tree.Find("base", "camera", 0, 0).state, FrameTree::State::kFound);
}

TEST(FrameTree, NamesTheFramesOfAPoseWithAWrongTime) {
  FrameTree tree{{}};
  std::string told;
  for (const int64_t utime : {1000, 2000, 900'000'000, 3000})
    told += tree.Add({"world", "base", utime, Turned(0, 0)}, 0);
  EXPECT_NE(told.find("a pose from 'world' to 'base' has a time that is far"), std::string::npos)
      << told;
}

TEST(FrameTree, WaitsForAPoseThatClosesAGap) {
  FrameTree tree{{}};
  tree.Add({"world", "base", 0, Turned(0, 0)}, 0);
  tree.Add({"world", "base", 5'000'000, Turned(9, 0)}, 0);
  const FrameTree::Answer gap = tree.Find("world", "base", 10'000, 0);
  EXPECT_EQ(gap.state, FrameTree::State::kWaiting);
  EXPECT_NE(gap.why.find("adapter.max_gap_ms"), std::string::npos) << gap.why;
  tree.Add({"world", "base", 20'000, Turned(2, 0)}, 0);
  EXPECT_NEAR(tree.Find("world", "base", 10'000, 0).pose.translation().x(), 1, 1e-12);
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
