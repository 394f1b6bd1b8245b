// Small sequences in the layout of 7-Scenes, and how their depth is registered.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sample_images.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

const char kSheared[] = "1 0.5 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

TEST(SevenScenes, PassesJpegThrough) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  const auto dataset = OpenOrFail(folder / "seq", {.camera_id = CameraId{3}});
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "7scenes");
  ASSERT_EQ(dataset->size(), 3u);
  const SensorFrame frame = ReadOrFail(*dataset, 1);
  EXPECT_EQ(frame.color, ColorJpeg(kWidth, kHeight));
  EXPECT_EQ(frame.header.frame_number, 2);
  EXPECT_EQ(frame.header.utime, 66667);
  EXPECT_EQ(frame.header.camera_id, CameraId{3});
  EXPECT_EQ(frame.header.camera, (PinholeCamera{16, 12, 525, 525, 8, 6}));
}

TEST(SevenScenes, ReadsIntrinsics) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  folder.Write("seq/camera-intrinsics.txt", "5.0e+02 0 8\n0 5.1e+02 6\n0 0 1\n");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->Header(0).camera, (PinholeCamera{16, 12, 500, 510, 8, 6}));
  EXPECT_EQ(ReadOrFail(*dataset, 2).depth(3, 3), 0) << "65535 is no return";
}

TEST(SevenScenes, RawKinectDepthAndPosesBecomeThoseOfTheColourCamera) {
  const TempFolder folder;
  WriteKinect(folder, 65535);
  const auto raw = OpenOrFail(folder / "seq");
  const auto registered =
      OpenOrFail(folder / "seq", {.registration = DepthRegistration::kRegistered});
  ASSERT_TRUE(raw && registered);
  const Pose T_D_C = registered->Header(0).T_W_C.inverse() * raw->Header(0).T_W_C;
  EXPECT_TRUE(T_D_C.linear().isIdentity(1e-9));
  EXPECT_TRUE(T_D_C.translation().isApprox(Eigen::Vector3d(0.025, 0, 0), 1e-9));
}

TEST(SevenScenes, DepthIsRegisteredUnlessTheSequenceOrTheOptionsSayOtherwise) {
  const TempFolder folder;
  WriteKinect(folder, 0);  // the intrinsics of a Kinect alone do not say so
  folder.Write("seq/camera-intrinsics.txt", "585 0 320\n0 585 240\n0 0 1\n");
  const auto dataset = OpenOrFail(folder / "seq");
  const auto told = OpenOrFail(folder / "seq", {.registration = DepthRegistration::kKinect});
  ASSERT_TRUE(dataset && told);
  EXPECT_EQ(dataset->Header(0).camera.fx, 585);
  EXPECT_THAT(dataset->remarks(), Contains(HasSubstr("depth counts as registered")));
  EXPECT_EQ(told->Header(0).camera.fx, 525);
  EXPECT_THAT(told->remarks(), Contains(HasSubstr("as the options say")));
}

TEST(SevenScenes, TheNameOfTheDataSetSaysThatDepthIsAKinects) {
  const TempFolder folder;
  WriteKinect(folder, 0);
  std::filesystem::create_directory(folder / "7scenes");
  std::filesystem::rename(folder / "seq", folder / "7scenes" / "seq-01");
  const auto dataset = OpenOrFail(folder / "7scenes" / "seq-01");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->Header(0).camera.fx, 525);
}

TEST(SevenScenes, AssumedIntrinsicsHoldForTheirSizeOnly) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  std::filesystem::remove(folder / "seq/camera-intrinsics.txt");
  EXPECT_THAT(ErrorOf(folder / "seq"),
              AllOf(HasSubstr("intrinsics are unknown"), HasSubstr("16x12"), HasSubstr("640x480"),
                    HasSubstr("--intrinsics")));
  const auto given = OpenOrFail(folder / "seq", {.intrinsics = {{20, 21, 7.5, 5.5}}});
  ASSERT_TRUE(given);
  EXPECT_EQ(given->Header(0).camera, (PinholeCamera{16, 12, 20, 21, 7.5, 5.5}));
}

TEST(SevenScenes, CountsUnusablePosesWithTheirReason) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  folder.Write("seq/frame-000000.pose.txt", kLost);
  folder.Write("seq/frame-000002.pose.txt", kSheared);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->size(), 1u);
  ASSERT_EQ(dataset->skipped().size(), 2u);
  EXPECT_THAT(dataset->skipped()[0].reason, HasSubstr("NaN or infinite"));
  EXPECT_THAT(dataset->skipped()[1].reason, HasSubstr("not rigid"));
  EXPECT_EQ(dataset->skipped()[1].frame_number, 2);
}

TEST(SevenScenes, UnderstandsNanOfOldWindows) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  std::string lost;
  for (int i = 0; i < 16; ++i) lost += "-1.#IND000e+000\t";
  folder.Write("seq/frame-000000.pose.txt", lost);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->skipped().size(), 1u);
}

}  // namespace
}  // namespace vismap
