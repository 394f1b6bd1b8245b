#include "map_tool/pose_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string ErrorOf(const TempFolder& folder, std::string_view text) {
  folder.Write("poses.txt", text);
  const auto poses = ReadTumTrajectory(folder / "poses.txt");
  return poses ? "" : poses.error().message;
}

TEST(PoseFile, HasTheTrajectoryThatASlamSystemWrote) {
  const TempFolder folder;
  folder.Write("poses.txt",
               "# timestamp tx ty tz qx qy qz qw\n"
               "1305031102.175304 1.5 -2 0.25 0 0 0.70710678 0.70710678\n"
               "0.1 0 0 0 0 0 0 1\n");
  const auto poses = ReadTumTrajectory(folder / "poses.txt");
  ASSERT_TRUE(poses) << poses.error().message;
  ASSERT_EQ(poses->size(), 2u);
  EXPECT_EQ((*poses)[0].utime, 1305031102175304);
  EXPECT_EQ((*poses)[0].T_W_C.translation(), Eigen::Vector3d(1.5, -2, 0.25));
  EXPECT_LT(
      ((*poses)[0].T_W_C.linear() * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitY()).norm(),
      1e-9);
  EXPECT_EQ((*poses)[1].utime, 100000);
  EXPECT_EQ((*poses)[1].T_W_C.matrix(), Pose::Identity().matrix());
}

TEST(PoseFile, IsRefusedWithTheLineThatIsWrong) {
  const TempFolder folder;
  EXPECT_THAT(ErrorOf(folder, "1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n"),
              AllOf(HasSubstr("poses.txt:2"), HasSubstr("expected TIME tx ty tz")));
  EXPECT_THAT(ErrorOf(folder, "1 0 0 nan 0 0 0 1\n"), HasSubstr("poses.txt:1"));
  EXPECT_THAT(ErrorOf(folder, "1 0 0 0 0 0 0 2\n"), HasSubstr("length 1"));
  EXPECT_THAT(ErrorOf(folder, "1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), HasSubstr("stand above"));
  EXPECT_THAT(ErrorOf(folder, "# nothing\n"), HasSubstr("no pose"));
  EXPECT_THAT(ReadTumTrajectory(folder / "missing").error().message, HasSubstr("missing"));
}

}  // namespace
}  // namespace vismap
