#include "geometry/pose.h"

#include <gtest/gtest.h>

#include <limits>

namespace vismap {
namespace {

Eigen::Matrix4d SomePose() {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  pose.translation() = Eigen::Vector3d(1, -2, 0.5);
  return pose.matrix();
}

TEST(MakePose, AcceptsARigidTransform) {
  const Result<Pose> pose = MakePose(SomePose());
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->matrix(), SomePose());
}

TEST(MakePose, CorrectsRoundingOnceAndThenChangesNothing) {
  Eigen::Matrix4d matrix = SomePose();
  matrix(0, 0) += 1e-4;
  const Result<Pose> once = MakePose(matrix);
  ASSERT_TRUE(once);
  const Result<Pose> twice = MakePose(once->matrix());
  ASSERT_TRUE(twice);
  EXPECT_EQ(once->matrix(), twice->matrix());
}

TEST(MakePose, NamesWhatIsWrong) {
  Eigen::Matrix4d matrix = SomePose();
  matrix(0, 3) = -std::numeric_limits<double>::infinity();
  EXPECT_NE(MakePose(matrix).error().message.find("NaN or infinite"), std::string::npos);
  matrix = SomePose() * 2;
  EXPECT_NE(MakePose(matrix).error().message.find("last row"), std::string::npos);
  matrix = SomePose();
  matrix.topLeftCorner<3, 3>() *= 1.1;
  EXPECT_NE(MakePose(matrix).error().message.find("not rigid"), std::string::npos);
  matrix = SomePose();
  matrix.col(0) *= -1;
  EXPECT_NE(MakePose(matrix).error().message.find("not rigid"), std::string::npos);
}

}  // namespace
}  // namespace vismap
