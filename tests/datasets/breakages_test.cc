// Every way to break a sequence gives an error that says what is wrong, and in which file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>

#include "sample_images.h"
#include "sample_sequences.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

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
      {"SceneNnDepthEmpty", WriteSceneNn, Put(depth2, ""), {"depth00002.png", "the header of a PNG"}},
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
       WritePlainTum,
       Remove("seq_fr1/depth/1305031236.105000.png"),
       {"depth/1305031236.105000.png"}},
      {"TumBadList",
       WritePlainTum,
       Put("seq_fr1/depth.txt", "1305031236.105000\n"),
       {"depth.txt:1", "TIME FILE"}},
      {"TumBadPose",
       WritePlainTum,
       Put("seq_fr1/groundtruth.txt", "1305031236.1 0 0 0 0 0 1\n"),
       {"groundtruth.txt:1"}},
      {"TumNoPoses", WritePlainTum, Put("seq_fr1/groundtruth.txt", "# none\n"), {"no poses"}},
      {"TumBadAssociations",
       WritePlainTum,
       Put("seq_fr1/associations.txt", "1 a.png 1 b.png\n"),
       {"associations.txt:1", "\"depth\""}},
      {"TumBadCamera",
       WritePlainTum,
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

TEST(OpenDataset, EveryBreakageIsTold) {
  for (const Breakage& breakage : Breakages()) {
    SCOPED_TRACE(breakage.name);
    const TempFolder folder;
    breakage.write(folder);
    const std::string path = breakage.write == WritePlainTum ? "seq_fr1" : "seq";
    EXPECT_EQ(ErrorOf(folder / path), "") << "before it is broken";
    breakage.breaks(folder);
    const std::string error = ErrorOf(folder / path);
    for (const std::string& word : breakage.says) EXPECT_THAT(error, HasSubstr(word));
  }
}

}  // namespace
}  // namespace vismap
