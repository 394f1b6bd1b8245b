// Small sequences in the layout of TUM RGB-D: pairs by time, interpolated poses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/frame_codec.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(Tum, AssociatesAndScales) {
  const TempFolder folder;
  WriteTum(folder);
  const auto dataset = OpenOrFail(folder / "seq_fr1_x");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "tum");
  ASSERT_EQ(dataset->size(), 3u);
  const SensorFrame frame = ReadOrFail(*dataset, 1);
  EXPECT_EQ(frame.header.frame_number, 1);
  EXPECT_EQ(frame.header.utime, 1305031236105000);
  EXPECT_EQ(frame.header.camera, (PinholeCamera{16, 12, 525, 525, 319.5, 239.5}));
  EXPECT_FLOAT_EQ(DecodeFrame(frame)->depth(0, 0), 2.0f);
  EXPECT_LT((frame.header.T_W_C.matrix() - RigidMatrix()).norm(), 1e-9);
}

TEST(Tum, LeavesOutFramesWithoutPartnerOrPose) {
  const TempFolder folder;
  WriteTum(folder);
  folder.Write("seq_fr1_x/rgb.txt",
               "1305031236.030000 rgb/1305031236.005000.png\n"
               "1305031236.100000 rgb/1305031236.105000.png\n"
               "1305031236.200000 rgb/1305031236.205000.png\n");
  folder.Write("seq_fr1_x/groundtruth.txt",
               "1305031236.100000 0 0 0 0 0 0 1\n"
               "1305031236.300000 0 0 0 0 0 0 1\n");
  const auto dataset = OpenOrFail(folder / "seq_fr1_x");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->size(), 1u);
  ASSERT_EQ(dataset->skipped().size(), 2u);
  EXPECT_THAT(dataset->skipped()[0].reason, HasSubstr("no colour image within 20 ms"));
  EXPECT_THAT(dataset->skipped()[1].reason, HasSubstr("no pose at time"));
}

TEST(Tum, WantsToKnowTheCamera) {
  const TempFolder folder;
  WriteTum(folder, "desk");
  std::filesystem::remove(folder / "desk/camera.txt");
  EXPECT_THAT(ErrorOf(folder / "desk"), HasSubstr("intrinsics are unknown"));
  folder.Write("desk/camera.txt", "500 501 7 5\n");
  const auto dataset = OpenOrFail(folder / "desk");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->Header(0).camera, (PinholeCamera{16, 12, 500, 501, 7, 5}));
  EXPECT_THAT(dataset->remarks(), Contains(AllOf(HasSubstr("fx 500 fy 501 cx 7 cy 5 (16x12)"),
                                                 HasSubstr("desk/camera.txt"))));
}

TEST(Tum, IntrinsicsAssumedByTheNameHoldForTheirSizeOnly) {
  const TempFolder folder;
  WriteTum(folder, "lab_fr1_walk");
  std::filesystem::remove(folder / "lab_fr1_walk/camera.txt");
  EXPECT_THAT(ErrorOf(folder / "lab_fr1_walk"), AllOf(HasSubstr("fr1"), HasSubstr("16x12")));
}

TEST(Tum, DepthStepsPerMetreAreTheFifthNumberOrAnOption) {
  const TempFolder folder;
  WriteTum(folder);
  EXPECT_EQ(ReadOrFail(*OpenOrFail(folder / "seq_fr1_x"), 0).depth_unit_m, 1.0 / 5000);
  folder.Write("seq_fr1_x/camera.txt", "500 501 7 5 1000\n");
  EXPECT_EQ(ReadOrFail(*OpenOrFail(folder / "seq_fr1_x"), 0).depth_unit_m, 0.001);
  EXPECT_EQ(ReadOrFail(*OpenOrFail(folder / "seq_fr1_x", {.depth_unit_m = 0.0001}), 0).depth_unit_m,
            0.0001);
}

TEST(Tum, PosesAreInterpolatedBetweenSamples) {
  const TempFolder folder;
  WriteTum(folder);
  folder.Write("seq_fr1_x/groundtruth.txt",
               "1305031235.985000 0 0 0 0 0 0 1\n"
               "1305031236.025000 2 4 0 0 0 0.70710678118 0.70710678118\n"
               "1305031236.205000 1 1 1 0 0 0 1\n");
  const auto dataset = OpenOrFail(folder / "seq_fr1_x");
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->size(), 2u);  // the second frame lies in a gap of 180 ms
  const Pose& middle = dataset->Header(0).T_W_C;
  EXPECT_NEAR((middle.translation() - Eigen::Vector3d(1, 2, 0)).norm(), 0, 1e-4);
  EXPECT_NEAR(Eigen::AngleAxisd(middle.linear()).angle(), M_PI / 4, 1e-4);
  EXPECT_EQ(dataset->Header(1).T_W_C.translation(), Eigen::Vector3d(1, 1, 1));
  EXPECT_THAT(dataset->skipped()[0].reason, HasSubstr("no pose at time"));
}

TEST(Tum, TimesOutOfRangeAreAnErrorWithTheirText) {
  const TempFolder folder;
  WriteTum(folder);
  folder.Write("seq_fr1_x/depth.txt", "1305031236005000000 depth/1305031236.005000.png\n");
  EXPECT_THAT(
      ErrorOf(folder / "seq_fr1_x"),
      AllOf(HasSubstr("depth.txt:1"), HasSubstr("1305031236005000000"), HasSubstr("nanoseconds")));
}

TEST(Tum, RepeatedLinesAndManyEqualTimesCostNothing) {
  const TempFolder folder;
  WriteTum(folder);
  std::string many;
  for (int i = 0; i < 20000; ++i) many += "1305031236.005000 rgb/1305031236.005000.png\n";
  folder.Write("seq_fr1_x/rgb.txt", many);
  std::string depths;
  for (int i = 0; i < 20000; ++i) depths += "1305031236.005000 depth/1305031236.005000.png\n";
  folder.Write("seq_fr1_x/depth.txt", depths);
  const auto dataset = OpenOrFail(folder / "seq_fr1_x");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->size(), 1u);
}

TEST(Tum, FilesOfWindowsAreRead) {
  const TempFolder folder;
  WriteTum(folder);
  folder.Write("seq_fr1_x/camera.txt",
               "\xEF\xBB\xBF"
               "500 501 7 5\r\n");
  const auto dataset = OpenOrFail(folder / "seq_fr1_x");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->Header(0).camera.fx, 500);
}

TEST(Tum, AQuaternionFarFromUnitLengthIsNoPose) {
  const TempFolder folder;
  WriteTum(folder);
  folder.Write("seq_fr1_x/groundtruth.txt", "1305031236.005000 0 0 0 0 0 0 0.9\n");
  EXPECT_THAT(ErrorOf(folder / "seq_fr1_x"),
              HasSubstr("no usable frames (2 of 3: there is no pose at"));
  folder.Write("seq_fr1_x/groundtruth.txt",
               "1305031236.005000 0 0 0 0 0 0 0.9\n"
               "1305031236.105000 0 0 0 0 0 0 0.9\n");
  EXPECT_THAT(ErrorOf(folder / "seq_fr1_x"),
              HasSubstr("no usable frames (2 of 3: the quaternion has length 0.9"));
}

}  // namespace
}  // namespace vismap
