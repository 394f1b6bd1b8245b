// Opens small folders of every format that the tests write, also with missing and malformed files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <set>

#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "datasets/dataset.h"
#include "sample_images.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

constexpr int kWidth = 16, kHeight = 12;
const char kRigid[] = "0 -1 0 1.5\n1 0 0 2.5\n0 0 1 3.5\n0 0 0 1\n";
const char kLost[] =
    "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n";
const char kSheared[] = "1 0.5 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

Eigen::Matrix4d RigidMatrix() {
  Eigen::Matrix4d matrix;
  matrix << 0, -1, 0, 1.5, 1, 0, 0, 2.5, 0, 0, 1, 3.5, 0, 0, 0, 1;
  return matrix;
}

std::string Digits(int number, size_t count) {
  const std::string digits = std::to_string(number);
  return std::string(count - digits.size(), '0') + digits;
}

void WriteSceneNn(const TempFolder& folder) {
  for (int k = 1; k <= 3; ++k) {
    folder.Write("seq/image/image" + Digits(k, 5) + ".png", ColorPng(kWidth, kHeight));
    folder.Write("seq/depth/depth" + Digits(k, 5) + ".png", GreyPng(kWidth, kHeight, 1000 * k));
  }
  folder.Write("intrinsic/asus.ini",
               "depth_width 16\ndepth_height 12\ndepth_fps 30\nfx 20\nfy 21\ncx 8\ncy 6\n");
  folder.Write("seq/timestamp.txt", "1 100000\n2 200000\n3 300000\n");
  folder.Write("seq/trajectory.log",
               std::string("0 0 1\n") + kRigid + "1 1 2\n" + kRigid + "2 2 3\n" + kRigid);
}

void WriteSevenScenes(const TempFolder& folder) {
  for (int k : {0, 2, 4}) {
    const std::string name = "seq/frame-" + Digits(k, 6);
    folder.Write(name + ".color.jpg", ColorJpeg(kWidth, kHeight));
    folder.Write(name + ".depth.png", GreyPng(kWidth, kHeight, k == 4 ? 65535 : 1000));
    folder.Write(name + ".pose.txt", kRigid);
  }
  folder.Write("seq/camera-intrinsics.txt", "525 0 8\n0 525 6\n0 0 1\n");
}

// As the original 7-Scenes: a Kinect's depth, whose pixels without a return are `hole`, and no
// intrinsics.
void WriteKinect(const TempFolder& folder, int hole) {
  folder.Write("seq/frame-000000.color.jpg", ColorJpeg(640, 480));
  folder.Write("seq/frame-000000.depth.png", GreyPng(640, 480, hole));
  folder.Write("seq/frame-000000.pose.txt", kRigid);
}

void WriteTum(const TempFolder& folder, const std::string& name = "seq_fr1_x") {
  std::string rgb = "# colour\n", depth = "# depth\n", poses = "# t x y z qx qy qz qw\n";
  for (int k = 0; k < 3; ++k) {
    const std::string time = "1305031236." + Digits(100000 * k + 5000, 6);
    folder.Write(name + "/rgb/" + time + ".png", ColorPng(kWidth, kHeight));
    folder.Write(name + "/depth/" + time + ".png", GreyPng(kWidth, kHeight, 5000 * (k + 1)));
    rgb += "1305031236." + Digits(100000 * k, 6) + " rgb/" + time + ".png\n";
    depth += time + " depth/" + time + ".png\n";
    poses += "1305031236." + Digits(100000 * k + 9000, 6) + " 1.5 2.5 3.5 0 0 0.7071 0.7071\n";
  }
  folder.Write(name + "/rgb.txt", rgb);
  folder.Write(name + "/depth.txt", depth);
  folder.Write(name + "/groundtruth.txt", poses);
  folder.Write(name + "/camera.txt", "525 525 319.5 239.5\n");
}

void WriteIcl(const TempFolder& folder) {
  std::string pairs, poses;
  for (int k = 0; k < 3; ++k) {
    const std::string n = std::to_string(k);
    folder.Write("seq/rgb/" + n + ".png", ColorPng(kWidth, kHeight));
    folder.Write("seq/depth/" + n + ".png", GreyPng(kWidth, kHeight, 5000));
    pairs += n + " depth/" + n + ".png " + n + " rgb/" + n + ".png\n";
    poses += n + " 1 2 3 0.6 0 0 0.8\n";
  }
  folder.Write("seq/associations.txt", pairs);
  folder.Write("seq/livingRoom0.gt.freiburg", poses);
  folder.Write("seq/camera.txt", "481.2 -480 319.5 239.5\n");
}

void WriteScanNet(const TempFolder& folder) {
  for (int k : {0, 10, 20}) {
    const std::string n = std::to_string(k);
    folder.Write("seq/color/" + n + ".jpg", ColorJpeg(2 * kWidth, 2 * kHeight));
    folder.Write("seq/depth/" + n + ".png", GreyPng(kWidth, kHeight, 1500));
    folder.Write("seq/pose/" + n + ".txt", kRigid);
  }
  folder.Write("seq/intrinsic/intrinsic_depth.txt", "20 0 7.5 0\n0 20 5.5 0\n0 0 1 0\n0 0 0 1\n");
  folder.Write("seq/intrinsic/intrinsic_color.txt", "40 0 15.5 0\n0 40 11.5 0\n0 0 1 0\n0 0 0 1\n");
}

void WriteReplica(const TempFolder& folder) {
  std::string poses;
  for (int k = 0; k < 3; ++k) {
    folder.Write("seq/results/frame" + Digits(k, 6) + ".jpg", ColorJpeg(kWidth, kHeight));
    folder.Write("seq/results/depth" + Digits(k, 6) + ".png", GreyPng(kWidth, kHeight, 13107));
    poses += "0 -1 0 1.5 1 0 0 2.5 0 0 1 3.5 0 0 0 1\n";
  }
  folder.Write("seq/traj.txt", poses);
  folder.Write("cam_params.json", R"({"camera": {"w": 16, "h": 12, "fx": 20.0, "fy": 21.0,
                                   "cx": 7.5, "cy": 5.5, "scale": 6553.5}})");
}

void WriteRedwood(const TempFolder& folder) {
  std::string log;
  for (int k = 0; k < 3; ++k) {
    folder.Write("seq/color/" + Digits(k, 5) + ".jpg", ColorJpeg(kWidth, kHeight));
    folder.Write("seq/depth/" + Digits(k, 5) + ".png", GreyPng(kWidth, kHeight, 1000));
    log += std::to_string(k) + " " + std::to_string(k) + " 1\n" + kRigid;
  }
  folder.Write("seq/trajectory.log", log);
  folder.Write("seq/intrinsics.txt", "# w h fx fy cx cy units\n16 12 20 21 7.5 5.5 1000\n");
}

std::unique_ptr<Dataset> OpenOrFail(const std::filesystem::path& path,
                                    const DatasetOptions& options = {}) {
  auto dataset = OpenDataset(path.string(), "", options);
  if (dataset) return std::move(*dataset);
  ADD_FAILURE() << dataset.error().message;
  return nullptr;
}

SensorFrame ReadOrFail(const Dataset& dataset, size_t i) {
  auto frame = dataset.Read(i);
  EXPECT_TRUE(frame) << frame.error().message;
  return frame.value_or(SensorFrame{});
}

/// The error of opening the sequence, or why one of its frames or its colour cannot be used; "" =
/// none.
std::string ErrorOf(const std::filesystem::path& path) {
  const auto dataset = OpenDataset(path.string(), "");
  if (!dataset) return dataset.error().message;
  for (const SkippedFrame& skipped : (*dataset)->skipped()) return skipped.reason;
  for (size_t i = 0; i < (*dataset)->size(); ++i) {
    const auto frame = (*dataset)->Read(i);
    if (!frame) return frame.error().message;
    if (!frame->color_problem.empty()) return frame->color_problem;
  }
  return "";
}

TEST(SceneNn, ReadsEverything) {
  const TempFolder folder;
  WriteSceneNn(folder);
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->format(), "scenenn");
  EXPECT_EQ(dataset->name(), "seq");
  ASSERT_EQ(dataset->size(), 3u);
  EXPECT_TRUE(dataset->skipped().empty());
  EXPECT_FALSE(dataset->default_detections_path());
  const SensorFrame frame = ReadOrFail(*dataset, 1);
  EXPECT_EQ(frame.header.frame_number, 2);
  EXPECT_EQ(frame.header.utime, 200000);
  EXPECT_EQ(frame.header.camera, (PinholeCamera{16, 12, 20, 21, 8, 6}));
  EXPECT_EQ(frame.header.T_W_C.matrix(), RigidMatrix());
  EXPECT_EQ(frame.depth(5, 5), 2000);
  const Result<RgbdFrame> decoded = DecodeFrame(frame);
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->depth(0, 0), 2.0f);
  EXPECT_GT(decoded->color(6, 2).r, 240);  // red left, green right
  EXPECT_LT(decoded->color(6, 2).b, 20);
  EXPECT_GT(decoded->color(6, 13).g, 240);
}

TEST(SceneNn, UsesTheIndexInTheTrajectoryNotItsOrder) {
  const TempFolder folder;
  WriteSceneNn(folder);
  folder.Write("seq/trajectory.log",
               std::string("2 2 3\n") + kRigid + "0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  ASSERT_EQ(dataset->size(), 2u);
  EXPECT_EQ(dataset->Header(0).T_W_C.matrix(), Eigen::Matrix4d::Identity());
  EXPECT_EQ(dataset->Header(1).T_W_C.matrix(), RigidMatrix());
  ASSERT_EQ(dataset->skipped().size(), 1u);
  EXPECT_EQ(dataset->skipped()[0].frame_number, 2);
  EXPECT_THAT(dataset->skipped()[0].reason, HasSubstr("no pose of index 1"));
}

TEST(SceneNn, WithoutTimestampsTheRateGivesTheTime) {
  const TempFolder folder;
  WriteSceneNn(folder);
  std::filesystem::remove(folder / "seq/timestamp.txt");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  EXPECT_EQ(dataset->Header(2).utime, 100000);
}

TEST(SceneNn, FindsDetectionsInTheFolder) {
  const TempFolder folder;
  WriteSceneNn(folder);
  folder.Write("seq/detections.json", "[]");
  const auto dataset = OpenOrFail(folder / "seq");
  ASSERT_TRUE(dataset);
  ASSERT_TRUE(dataset->default_detections_path());
  EXPECT_THAT(*dataset->default_detections_path(), HasSubstr("seq/detections.json"));
}

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
  folder.Write("seq/camera_intrinsic.json", R"({"width": 16, "intrinsic_matrix": 3})");
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("camera_intrinsic.json: expected"));
}

TEST(Redwood, OtherNumbersOfPosesThanOfImagesAreAnError) {
  const TempFolder folder;
  WriteRedwood(folder);
  folder.Write("seq/trajectory.log", std::string("0 0 1\n") + kRigid + "1 1 2\n" + kRigid);
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("2 poses for 3 images"));
}

TEST(OpenDataset, StrideCountsRecordedFramesMaxFramesUsableOnes) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  EXPECT_EQ(OpenOrFail(folder / "seq", {.stride = 2})->Header(1).frame_number, 4);
  EXPECT_EQ(OpenOrFail(folder / "seq", {.max_frames = 2})->size(), 2u);
  folder.Write("seq/frame-000000.pose.txt", kLost);
  const auto dataset = OpenOrFail(folder / "seq", {.max_frames = 1});
  EXPECT_EQ(dataset->Header(0).frame_number, 2);
  EXPECT_EQ(dataset->skipped().size(), 1u);
}

TEST(OpenDataset, RefusesBadOptionsFoldersAndFormats) {
  const TempFolder folder;
  WriteSevenScenes(folder);
  const std::string path = (folder / "seq").string();
  EXPECT_THAT(OpenDataset(path, "", {.stride = 0}).error().message, HasSubstr("stride is 0"));
  EXPECT_THAT(OpenDataset(path, "", {.max_frames = -1}).error().message, HasSubstr("max_frames"));
  EXPECT_THAT(OpenDataset(path, "kitti").error().message,
              AllOf(HasSubstr("\"kitti\""), HasSubstr("7scenes")));
  EXPECT_THAT(OpenDataset(path, "scenenn").error().message, HasSubstr("asus.ini"));
  EXPECT_TRUE(OpenDataset(path, "7scenes"));
  EXPECT_THAT(OpenDataset(path + "/nothing", "").error().message, HasSubstr("No such file"));
  EXPECT_THAT(OpenDataset(path + "/frame-000000.pose.txt", "").error().message,
              HasSubstr("expected a folder"));
  EXPECT_THAT(OpenDataset(folder.path().string(), "").error().message,
              HasSubstr("no known sequence"));
}

/// A way to break a sequence, and the words that the error must contain.
struct Breakage {
  const char* name;
  void (*write)(const TempFolder&);
  std::function<void(const TempFolder&)> breaks;
  std::vector<std::string> says;
};

std::function<void(const TempFolder&)> Remove(const std::string& name) {
  return [name](const TempFolder& folder) { std::filesystem::remove(folder / name); };
}

std::function<void(const TempFolder&)> Put(const std::string& name, const std::string& content) {
  return [=](const TempFolder& folder) { folder.Write(name, content); };
}

std::function<void(const TempFolder&)> Put(const std::string& name,
                                           const std::vector<uint8_t>& content) {
  return [=](const TempFolder& folder) { folder.Write(name, content); };
}

std::vector<uint8_t> Half(std::vector<uint8_t> bytes) {
  bytes.resize(bytes.size() / 2);
  return bytes;
}

std::vector<uint8_t> Damaged(std::vector<uint8_t> bytes) {
  bytes[bytes.size() / 2] ^= 0xff;
  return bytes;
}

void PlainTum(const TempFolder& folder) { WriteTum(folder, "seq_fr1"); }

std::vector<Breakage> Breakages() {
  const std::string image2 = "seq/image/image00002.png", depth2 = "seq/depth/depth00002.png";
  const std::string frame2 = "seq/frame-000002";
  return {
      {"SceneNnDepthMissing", WriteSceneNn, Remove(depth2), {"image00002.png", "no depth image"}},
      {"SceneNnColourMissing", WriteSceneNn, Remove(image2), {"depth00002.png", "no colour image"}},
      {"SceneNnDepthTruncated",
       WriteSceneNn,
       Put(depth2, Half(GreyPng(kWidth, kHeight, 7))),
       {"depth00002.png", "truncated"}},
      {"SceneNnDepthEmpty", WriteSceneNn, Put(depth2, ""), {"depth00002.png", "neither a PNG"}},
      {"SceneNnDepthDamaged",
       WriteSceneNn,
       Put(depth2, Damaged(GreyPng(kWidth, kHeight, 7))),
       {"depth00002.png", "damaged"}},
      {"SceneNnDepth8Bit",
       WriteSceneNn,
       Put(depth2, GreyPng(kWidth, kHeight, 7, 8)),
       {"depth00002.png", "expected a 16-bit", "found 8-bit"}},
      {"SceneNnDepthInColour",
       WriteSceneNn,
       Put(depth2, ColorPng(kWidth, kHeight)),
       {"depth00002.png", "8-bit colour"}},
      {"SceneNnDepthIsJpeg",
       WriteSceneNn,
       Put(depth2, ColorJpeg(kWidth, kHeight)),
       {"depth00002.png", "expected a 16-bit"}},
      {"SceneNnDepthOfOtherSize",
       WriteSceneNn,
       Put(depth2, GreyPng(kWidth, 10, 7)),
       {"depth00002.png", "16x10; expected 16x12"}},
      {"SceneNnColourOfOtherSize",
       WriteSceneNn,
       Put(image2, ColorPng(32, 24)),
       {"image00002.png", "32x24; expected 16x12"}},
      {"SceneNnColourTruncated",
       WriteSceneNn,
       Put(image2, Half(ColorPng(kWidth, kHeight))),
       {"image00002.png"}},
      {"SceneNnColourIsText", WriteSceneNn, Put(image2, "hello"), {"image00002.png", "neither"}},
      {"SceneNnIniMissing", WriteSceneNn, Remove("intrinsic/asus.ini"), {"asus.ini"}},
      {"SceneNnIniWithoutFx",
       WriteSceneNn,
       Put("intrinsic/asus.ini", "depth_width 16\ndepth_height 12\nfy 1\ncx 1\ncy 1\n"),
       {"asus.ini", "fx"}},
      {"SceneNnIniWithZeroFx",
       WriteSceneNn,
       Put("intrinsic/asus.ini", "depth_width 16\ndepth_height 12\nfx 0\nfy 1\ncx 1\ncy 1\n"),
       {"focal lengths are fx 0"}},
      {"SceneNnTimestampMissing",
       WriteSceneNn,
       Put("seq/timestamp.txt", "1 100000\n3 300000\n"),
       {"timestamp.txt", "no line for image 2"}},
      {"SceneNnTimestampIsText",
       WriteSceneNn,
       Put("seq/timestamp.txt", "1 100000\n2 soon\n"),
       {"timestamp.txt:2"}},
      {"SceneNnTimestampGoesBack",
       WriteSceneNn,
       Put("seq/timestamp.txt", "1 100000\n2 100000\n3 300000\n"),
       {"frame 2", "not after 100000"}},
      {"SceneNnTrajectoryCutOff",
       WriteSceneNn,
       Put("seq/trajectory.log", std::string("0 0 1\n") + kRigid + "1 1 2\n0 -1 0 1.5\n"),
       {"trajectory.log:6", "four rows"}},
      {"SceneNnTrajectoryIsText",
       WriteSceneNn,
       Put("seq/trajectory.log", "0 0 1\n1 0 x 0\n1\n1\n1\n"),
       {"trajectory.log:2", "four numbers"}},
      {"SceneNnPoseTwice",
       WriteSceneNn,
       Put("seq/trajectory.log", std::string("0 0 1\n") + kRigid + "0 0 1\n" + kRigid),
       {"trajectory.log", "two poses of index 0"}},
      {"SevenScenesPoseMissing",
       WriteSevenScenes,
       Remove(frame2 + ".pose.txt"),
       {"frame-000002.pose.txt"}},
      {"SevenScenesPoseCutOff",
       WriteSevenScenes,
       Put(frame2 + ".pose.txt", "1 0 0 0\n0 1 0 0\n"),
       {"frame-000002.pose.txt", "expected 16 numbers, found 8"}},
      {"SevenScenesPoseIsText",
       WriteSevenScenes,
       Put(frame2 + ".pose.txt", "1 0 0 0\n0 1 O 0\n"),
       {"frame-000002.pose.txt:2", "expected a number, found \"O\""}},
      {"SevenScenesDepthMissing",
       WriteSevenScenes,
       Remove(frame2 + ".depth.png"),
       {"frame-000002.color.jpg", "no depth image"}},
      {"SevenScenesColourTwice",
       WriteSevenScenes,
       Put(frame2 + ".color.png", ColorPng(kWidth, kHeight)),
       {"two files have number 2"}},
      {"SevenScenesJpegTruncated",
       WriteSevenScenes,
       Put(frame2 + ".color.jpg", Half(ColorJpeg(kWidth, kHeight))),
       {"frame-000002.color.jpg"}},
      {"SevenScenesColourOfOtherSize",
       WriteSevenScenes,
       Put(frame2 + ".color.jpg", ColorJpeg(20, 12)),
       {"frame-000002.color.jpg", "20x12; expected 16x12"}},
      {"SevenScenesBadIntrinsics",
       WriteSevenScenes,
       Put("seq/camera-intrinsics.txt", "1 2 3"),
       {"camera-intrinsics.txt", "expected 9 numbers"}},
      {"TumImageMissing",
       PlainTum,
       Remove("seq_fr1/depth/1305031236.105000.png"),
       {"depth/1305031236.105000.png"}},
      {"TumBadList",
       PlainTum,
       Put("seq_fr1/depth.txt", "1305031236.105000\n"),
       {"depth.txt:1", "TIME FILE"}},
      {"TumBadPose",
       PlainTum,
       Put("seq_fr1/groundtruth.txt", "1305031236.1 0 0 0 0 0 1\n"),
       {"groundtruth.txt:1"}},
      {"TumNoPoses", PlainTum, Put("seq_fr1/groundtruth.txt", "# none\n"), {"no poses"}},
      {"TumBadAssociations",
       PlainTum,
       Put("seq_fr1/associations.txt", "1 a.png 1 b.png\n"),
       {"associations.txt:1", "\"depth\""}},
      {"TumBadCamera",
       PlainTum,
       Put("seq_fr1/camera.txt", "500 500 8\n"),
       {"camera.txt", "expected four numbers"}},
      {"IclNameWithoutNumber",
       WriteIcl,
       [](const TempFolder& folder) {
         folder.Write("seq/associations.txt", "0 depth/x.png 0 rgb/0.png\n");
         folder.Write("seq/depth/x.png", GreyPng(kWidth, kHeight, 1));
       },
       {"x.png", "expected a number"}},
      {"ScanNetPoseMissing", WriteScanNet, Remove("seq/pose/10.txt"), {"pose/10.txt"}},
      {"ScanNetIntrinsicsMissing",
       WriteScanNet,
       Remove("seq/intrinsic/intrinsic_depth.txt"),
       {"intrinsic_depth.txt"}},
      {"ScanNetColourIntrinsicsMissing",
       WriteScanNet,
       Remove("seq/intrinsic/intrinsic_color.txt"),
       {"intrinsic_color.txt"}},
      {"ScanNetColourOfOtherSize",
       WriteScanNet,
       Put("seq/color/10.jpg", ColorJpeg(10, 10)),
       {"10.jpg", "10x10; expected 32x24"}},
      {"ReplicaParametersMissing", WriteReplica, Remove("cam_params.json"), {"cam_params.json"}},
      {"ReplicaParametersBroken",
       WriteReplica,
       Put("cam_params.json", "{\"camera\": {"),
       {"cam_params.json"}},
      {"ReplicaParametersWithoutScale",
       WriteReplica,
       Put("cam_params.json", R"({"camera":{"w":16,"h":12,"fx":1,"fy":1,"cx":1,"cy":1}})"),
       {"camera.scale"}},
      {"ReplicaTrajectoryCutOff",
       WriteReplica,
       Put("seq/traj.txt", "1 0 0 0\n"),
       {"traj.txt:1", "expected 16 numbers"}},
      {"RedwoodBadIntrinsics",
       WriteRedwood,
       Put("seq/intrinsics.txt", "16 12 20 21\n"),
       {"intrinsics.txt", "expected 7 numbers"}},
  };
}

/// The images of the second and of the last frame of a small sequence.
struct Images {
  const char* name;
  void (*write)(const TempFolder&);
  std::string folder, color2, depth2, color3, depth3;
};

std::vector<Images> AllFormats() {
  const auto tum = [](const std::string& kind, int k) {
    return kind + "/1305031236." + Digits(100000 * k + 5000, 6) + ".png";
  };
  return {
      {"scenenn", WriteSceneNn, "seq", "image/image00002.png", "depth/depth00002.png",
       "image/image00003.png", "depth/depth00003.png"},
      {"7scenes", WriteSevenScenes, "seq", "frame-000002.color.jpg", "frame-000002.depth.png",
       "frame-000004.color.jpg", "frame-000004.depth.png"},
      {"tum", PlainTum, "seq_fr1", tum("rgb", 1), tum("depth", 1), tum("rgb", 2), tum("depth", 2)},
      {"icl", WriteIcl, "seq", "rgb/1.png", "depth/1.png", "rgb/2.png", "depth/2.png"},
      {"scannet", WriteScanNet, "seq", "color/10.jpg", "depth/10.png", "color/20.jpg",
       "depth/20.png"},
      {"replica", WriteReplica, "seq", "results/frame000001.jpg", "results/depth000001.png",
       "results/frame000002.jpg", "results/depth000002.png"},
      {"redwood", WriteRedwood, "seq", "color/00001.jpg", "depth/00001.png", "color/00002.jpg",
       "depth/00002.png"},
  };
}

/// How many frames of a sequence can be read, and how many of them with colour.
std::pair<int, int> CountFrames(const std::filesystem::path& path) {
  const auto dataset = OpenOrFail(path);
  int frames = 0, colored = 0;
  for (size_t i = 0; dataset && i < dataset->size(); ++i) {
    const auto frame = dataset->Read(i);
    if (!frame) continue;
    ++frames;
    colored += DecodeFrame(*frame)->color.empty() ? 0 : 1;
  }
  return {frames, colored};
}

void CutInHalf(const std::filesystem::path& path) {
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
}

TEST(OpenDataset, OneDamagedImageCostsOnlyItself) {
  for (const Images& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    const auto left_after = [&](const std::string& image, const auto& damage) {
      const TempFolder folder;
      images.write(folder);
      damage(folder / images.folder / image);
      return CountFrames(folder / images.folder);
    };
    const auto empty = [](const std::filesystem::path& path) {
      std::filesystem::resize_file(path, 0);
    };
    using Counts = std::pair<int, int>;
    EXPECT_EQ(left_after(images.color2, CutInHalf), Counts(3, 2));
    EXPECT_EQ(left_after(images.depth2, CutInHalf), Counts(2, 2));
    EXPECT_EQ(left_after(images.color3, CutInHalf), Counts(2, 2)) << "the last image is cut off";
    EXPECT_EQ(left_after(images.depth3, CutInHalf), Counts(2, 2));
    EXPECT_EQ(left_after(images.color3, empty), Counts(2, 2));
    EXPECT_EQ(left_after(images.depth3, empty), Counts(2, 2));
  }
}

TEST(OpenDataset, ADamagedFirstImageCostsOnlyItself) {
  for (const Images& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    for (const bool depth : {false, true}) {
      const TempFolder folder;
      images.write(folder);
      const std::filesystem::path second =
          folder / images.folder / (depth ? images.depth2 : images.color2);
      // The first frame's image is the first one of its kind by name.
      const std::string start = second.filename().string().substr(0, 1);
      std::set<std::filesystem::path> siblings;
      for (const auto& entry : std::filesystem::directory_iterator(second.parent_path())) {
        const std::string file = entry.path().filename().string();
        const bool same_kind =
            std::string(images.name) == "7scenes"
                ? file.find(depth ? ".depth." : ".color.") != std::string::npos
                : std::string(images.name) != "replica" || file.starts_with(start);
        if (same_kind) siblings.insert(entry.path());
      }
      CutInHalf(*siblings.begin());
      EXPECT_EQ(CountFrames(folder / images.folder), depth ? std::pair(2, 2) : std::pair(3, 2));
    }
  }
}

TEST(OpenDataset, BytesAfterTheEndOfAPngCostNothing) {
  for (const Images& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    const TempFolder folder;
    images.write(folder);
    for (const std::string& image : {images.color2, images.depth2, images.color3, images.depth3})
      std::ofstream(folder / images.folder / image, std::ios::app) << std::string(512, '\0');
    EXPECT_EQ(CountFrames(folder / images.folder), std::pair(3, 3));
  }
}

TEST(OpenDataset, ColourOf16BitsIsRead) {
  const TempFolder folder;
  WriteSceneNn(folder);
  folder.Write("seq/image/image00002.png", ColorPng(kWidth, kHeight, 16));
  EXPECT_EQ(CountFrames(folder / "seq"), std::pair(3, 3));
}

TEST(OpenDataset, AnImageWithoutPartnerAtTheEndCostsOnlyItself) {
  for (const Images& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    for (const std::string& image : {images.color3, images.depth3}) {
      const TempFolder folder;
      images.write(folder);
      std::filesystem::remove(folder / images.folder / image);
      EXPECT_EQ(CountFrames(folder / images.folder).second, 2) << image;
    }
  }
}

TEST(Redwood, WithoutTheLastImageItsPoseMayBeMissingToo) {
  const TempFolder folder;
  WriteRedwood(folder);
  folder.Write("seq/color/00003.jpg", ColorJpeg(kWidth, kHeight));
  EXPECT_EQ(CountFrames(folder / "seq"), std::pair(3, 3));
  folder.Write("seq/depth/00003.png", GreyPng(kWidth, kHeight, 1000));
  EXPECT_THAT(ErrorOf(folder / "seq"), HasSubstr("cannot be told"));
}

TEST(OpenDataset, NumbersThatAreTimesInNanosecondsAreAnErrorWithTheirText) {
  const TempFolder folder;
  WriteScanNet(folder);
  folder.Write("seq/depth/1305031236005000000.png", GreyPng(kWidth, kHeight, 1500));
  folder.Write("seq/color/1305031236005000000.jpg", ColorJpeg(2 * kWidth, 2 * kHeight));
  EXPECT_THAT(ErrorOf(folder / "seq"),
              AllOf(HasSubstr("1305031236005000000 is out of range"), HasSubstr("nanoseconds")));
}

TEST(OpenDataset, TextFilesMayBeginWithAByteOrderMark) {
  for (const Images& images : AllFormats()) {
    SCOPED_TRACE(images.name);
    const TempFolder folder;
    images.write(folder);
    namespace fs = std::filesystem;
    for (const auto& entry : fs::recursive_directory_iterator(folder.path())) {
      const std::string extension = entry.path().extension().string();
      if (!entry.is_regular_file() || extension == ".png" || extension == ".jpg") continue;
      std::ifstream file(entry.path(), std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(file), {}};
      for (size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2)
        text.replace(at, 1, "\r\n");
      std::ofstream(entry.path(), std::ios::binary) << "\xEF\xBB\xBF" << text;
    }
    EXPECT_EQ(CountFrames(folder / images.folder), std::pair(3, 3));
  }
}

TEST(OpenDataset, OnlySequencesWithTimesHaveAClock) {
  for (const Images& images : AllFormats()) {
    const TempFolder folder;
    images.write(folder);
    const std::string name = images.name;
    EXPECT_EQ(OpenOrFail(folder / images.folder)->has_clock(), name == "scenenn" || name == "tum")
        << name;
  }
}

TEST(OpenDataset, EveryBreakageIsTold) {
  for (const Breakage& breakage : Breakages()) {
    SCOPED_TRACE(breakage.name);
    const TempFolder folder;
    breakage.write(folder);
    const std::string path = breakage.write == PlainTum ? "seq_fr1" : "seq";
    EXPECT_EQ(ErrorOf(folder / path), "") << "before it is broken";
    breakage.breaks(folder);
    const std::string error = ErrorOf(folder / path);
    for (const std::string& word : breakage.says) EXPECT_THAT(error, HasSubstr(word));
  }
}

}  // namespace
}  // namespace vismap
