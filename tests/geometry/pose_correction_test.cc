#include "geometry/pose_correction.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

Pose Moved(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& translation) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

double Difference(const Pose& a, const Pose& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

TEST(PartOfMotion, IsNothingAtZeroAllAtOneAndHalvesMakeTheWhole) {
  for (const double angle : {0.0, 1e-12, 1e-9, 1e-5, 0.0099, 0.0101, 0.7, 3.0}) {
    const Pose motion = Moved(angle, {1, 2, -3}, {0.5, -1, 2});
    EXPECT_LT(Difference(PartOfMotion(motion, 0), Pose::Identity()), 1e-15) << angle;
    EXPECT_LT(Difference(PartOfMotion(motion, 1), motion), 1e-12) << angle;
    const Pose half = PartOfMotion(motion, 0.5);
    EXPECT_LT(Difference(half * half, motion), 1e-12) << angle;
    EXPECT_LT(Difference(PartOfMotion(motion, 0.3) * PartOfMotion(motion, 0.7), motion), 1e-12);
  }
}

TEST(PartOfMotion, OfATurnAboutADistantAxisStaysOnTheCircle) {
  const Eigen::Vector3d center(4, 1, 0);
  const Eigen::Matrix3d turn = Moved(1.5, {0, 0, 1}, {0, 0, 0}).linear();
  Pose motion = Pose::Identity();
  motion.linear() = turn;
  motion.translation() = center - turn * center;
  for (const double part : {0.1, 0.5, 0.9}) {
    const Eigen::Vector3d point = PartOfMotion(motion, part) * Eigen::Vector3d::Zero();
    EXPECT_NEAR((point - center).norm(), center.norm(), 1e-12) << part;
    EXPECT_NEAR(point.z(), 0, 1e-12);
  }
}

// Frames along a line, 100 us apart, with ids 0, 1, ...
std::vector<PoseAtTime> Line(int count) {
  std::vector<PoseAtTime> frames;
  for (int i = 0; i < count; ++i)
    frames.push_back({100 * i, Moved(0.1 * i, {1, 1, 0}, {0.2 * i, 0, 0.1})});
  return frames;
}

TEST(InterpolateCorrections, GivesKnownFramesExactlyTheirPose) {
  const std::vector<PoseAtTime> frames = Line(5);
  const std::vector<PoseAtTime> known = {{100, Moved(0.3, {0, 1, 0}, {1, 2, 3})},
                                         {300, Moved(0.2, {1, 0, 0}, {3, 2, 1})}};
  const std::vector<Pose> poses = InterpolateCorrections(frames, known);
  ASSERT_EQ(poses.size(), 5u);
  EXPECT_EQ(poses[1].matrix(), known[0].T_W_C.matrix());
  EXPECT_EQ(poses[3].matrix(), known[1].T_W_C.matrix());
}

TEST(InterpolateCorrections, CarriesTheOthersWithTheirNeighboursInTime) {
  std::vector<PoseAtTime> frames = Line(7);
  const Pose first = Moved(0.1, {0, 0, 1}, {0.1, 0, 0});
  const Pose second = Moved(0.3, {0, 0, 1}, {0.1, 0.4, 0});
  const std::vector<PoseAtTime> known = {{200, first * frames[2].T_W_C},
                                         {400, second * frames[4].T_W_C}};
  frames.push_back({350, frames[1].T_W_C});  // the order of the frames does not matter
  const std::vector<Pose> poses = InterpolateCorrections(frames, known);
  for (const size_t before : {0u, 1u})
    EXPECT_LT(Difference(poses[before], first * frames[before].T_W_C), 1e-12);
  for (const size_t after : {5u, 6u})
    EXPECT_LT(Difference(poses[after], second * frames[after].T_W_C), 1e-12);
  const Pose between = first.inverse() * second;
  EXPECT_LT(Difference(poses[3], first * PartOfMotion(between, 0.5) * frames[3].T_W_C), 1e-12);
  EXPECT_LT(Difference(poses[7], first * PartOfMotion(between, 0.75) * frames[7].T_W_C), 1e-12);
}

TEST(InterpolateCorrections, OfOnePoseMovesTheWholeTrajectory) {
  const std::vector<PoseAtTime> frames = Line(4);
  const Pose correction = Moved(0.5, {1, 2, 3}, {1, 1, 1});
  const std::vector<Pose> poses =
      InterpolateCorrections(frames, std::vector<PoseAtTime>{{300, correction * frames[3].T_W_C}});
  for (size_t i = 0; i < 4; ++i)
    EXPECT_LT(Difference(poses[i], correction * frames[i].T_W_C), 1e-12);
}

}  // namespace
}  // namespace vismap
