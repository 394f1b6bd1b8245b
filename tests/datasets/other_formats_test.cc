// Small sequences in the layouts of ICL-NUIM, ScanNet, Replica and Redwood.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "sample_images.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

// With y up in the image, a pixel of ICL below the centre (v > cy) at depth z is the point
// (.., (v - cy) / fy * z < 0, z), turned into the world by the file's pose. Our world mirrors y.
TEST(Icl, ANegativeFyMirrorsCameraAndWorld) {
  const TempFolder folder;
  WriteIcl(folder);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "icl");
  ASSERT_EQ(dataset->size(), 3u);
  const FrameHeader header = dataset->Header(2);
  EXPECT_EQ(header.frame_number, 2);
  EXPECT_EQ(header.utime, 66667);
  EXPECT_EQ(header.camera, (PinholeCamera{16, 12, 481.2, 480, 319.5, 239.5}));
  EXPECT_NEAR(header.T_W_C.linear().determinant(), 1, 1e-12);
  const double u = 100, v = 300, z = 2;
  const Eigen::Vector3d p_left((u - 319.5) / 481.2 * z, (v - 239.5) / -480 * z, z);
  const Eigen::Vector3d expected =
      Eigen::Quaterniond(0.8, 0.6, 0, 0).toRotationMatrix() * p_left + Eigen::Vector3d(1, 2, 3);
  const Eigen::Vector3d found = header.T_W_C * header.camera.BackProject(u, v, z);
  EXPECT_LT((found - Eigen::Vector3d(expected.x(), -expected.y(), expected.z())).norm(), 1e-12);
}

TEST(ScanNet, ResamplesColourToDepth) {
  const TempFolder folder;
  WriteScanNet(folder);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "scannet");
  ASSERT_EQ(dataset->size(), 3u);
  const SensorFrame frame = ReadOrFail(*dataset, 2);
  EXPECT_EQ(frame.header.frame_number, 20);
  EXPECT_EQ(*ReadJpegSize(frame.color), (JpegSize{kWidth, kHeight}));
  const Result<RgbdFrame> decoded = DecodeFrame(frame);
  ASSERT_TRUE(decoded);
  EXPECT_GT(decoded->color(6, 5).r, 230);
  EXPECT_GT(decoded->color(6, 10).g, 230);
}

TEST(ScanNet, ColourOfTheSizeOfDepthPassesThrough) {
  const TempFolder folder;
  WriteScanNet(folder);
  for (const char* n : {"0", "10", "20"}) {
    folder.Write(std::string("seq/color/") + n + ".jpg", ColorJpeg(kWidth, kHeight));
  }
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(ReadOrFail(*dataset, 0).color, ColorJpeg(kWidth, kHeight));
}

TEST(ScanNet, LostTrackingIsCounted) {
  const TempFolder folder;
  WriteScanNet(folder);
  folder.Write("seq/pose/10.txt", kLost);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->size(), 2u);
  EXPECT_EQ(dataset->skipped().size(), 1u);
}

TEST(Replica, ReadsParametersBesideTheFolder) {
  const TempFolder folder;
  WriteReplica(folder);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "replica");
  ASSERT_EQ(dataset->size(), 3u);
  const SensorFrame frame = ReadOrFail(*dataset, 2);
  EXPECT_EQ(frame.header.frame_number, 2);
  EXPECT_EQ(frame.header.camera, (PinholeCamera{16, 12, 20, 21, 7.5, 5.5}));
  EXPECT_FLOAT_EQ(DecodeFrame(frame)->depth(0, 0), 2.0f);
  EXPECT_EQ(frame.header.T_W_C.matrix(), RigidMatrix());
}

TEST(Redwood, ReadsEverything) {
  const TempFolder folder;
  WriteRedwood(folder);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "redwood");
  EXPECT_EQ(dataset->size(), 3u);
  EXPECT_EQ(dataset->Header(0).camera, (PinholeCamera{16, 12, 20, 21, 7.5, 5.5}));
  EXPECT_EQ(ReadOrFail(*dataset, 0).header.T_W_C.matrix(), RigidMatrix());
}

TEST(Redwood, ReadsTheIntrinsicsOfOpen3dsRecorders) {
  const TempFolder folder;
  WriteRedwood(folder);
  std::filesystem::remove(folder / "seq/intrinsics.txt");
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("intrinsics are unknown"));
  folder.Write("seq/camera_intrinsic.json", R"({"width": 16, "height": 12,
      "intrinsic_matrix": [20.0, 0, 0, 0, 21.0, 0, 7.5, 5.5, 1]})");
  EXPECT_EQ(OpenOrFail(folder / "seq")->Header(0).camera,
            (PinholeCamera{16, 12, 20, 21, 7.5, 5.5}));
  folder.Write("seq/camera_intrinsic.json", R"({"width": 16, "height": 12,
      "intrinsic_matrix": [20.0, 0, 7.5, 0, 21.0, 5.5, 0, 0, 1]})");
  EXPECT_EQ(OpenOrFail(folder / "seq")->Header(0).camera, (PinholeCamera{16, 12, 20, 21, 7.5, 5.5}))
      << "row by row";
  folder.Write("seq/camera_intrinsic.json", R"({"width": 16, "intrinsic_matrix": 3})");
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("camera_intrinsic.json: expected"));
}

TEST(Redwood, OtherNumbersOfPosesThanOfImagesAreAnError) {
  const TempFolder folder;
  WriteRedwood(folder);
  folder.Write("seq/trajectory.log", std::string("0 0 1\n") + kRigid + "1 1 2\n" + kRigid);
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("2 poses for 3 images"));
}

TEST(Redwood, WithoutTheLastImageItsPoseMayBeMissingToo) {
  const TempFolder folder;
  WriteRedwood(folder);
  folder.Write("seq/color/00003.jpg", ColorJpeg(kWidth, kHeight));
  EXPECT_EQ(CountFrames(folder / "seq"), std::pair(3, 3));
  folder.Write("seq/depth/00003.png", GreyPng(kWidth, kHeight, 1000));
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("cannot be told"));
}

}  // namespace
}  // namespace vismap
