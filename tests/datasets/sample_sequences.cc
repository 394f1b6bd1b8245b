#include "sample_sequences.h"

#include <gtest/gtest.h>

#include "codecs/frame_codec.h"
#include "sample_images.h"

namespace vismap {

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

void WriteKinect(const TempFolder& folder, int hole) {
  folder.Write("seq/frame-000000.color.jpg", ColorJpeg(640, 480));
  folder.Write("seq/frame-000000.depth.png", GreyPng(640, 480, hole));
  folder.Write("seq/frame-000000.pose.txt", kRigid);
}

void WriteTum(const TempFolder& folder, const std::string& name) {
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
                                    const DatasetOptions& options) {
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

void WritePlainTum(const TempFolder& folder) { WriteTum(folder, "seq_fr1"); }

std::vector<SampleSequence> AllFormats() {
  const auto tum = [](const std::string& kind, int k) {
    return kind + "/1305031236." + Digits(100000 * k + 5000, 6) + ".png";
  };
  return {
      {"scenenn", WriteSceneNn, "seq", "image/image00002.png", "depth/depth00002.png",
       "image/image00003.png", "depth/depth00003.png"},
      {"7scenes", WriteSevenScenes, "seq", "frame-000002.color.jpg", "frame-000002.depth.png",
       "frame-000004.color.jpg", "frame-000004.depth.png"},
      {"tum", WritePlainTum, "seq_fr1", tum("rgb", 1), tum("depth", 1), tum("rgb", 2),
       tum("depth", 2)},
      {"icl", WriteIcl, "seq", "rgb/1.png", "depth/1.png", "rgb/2.png", "depth/2.png"},
      {"scannet", WriteScanNet, "seq", "color/10.jpg", "depth/10.png", "color/20.jpg",
       "depth/20.png"},
      {"replica", WriteReplica, "seq", "results/frame000001.jpg", "results/depth000001.png",
       "results/frame000002.jpg", "results/depth000002.png"},
      {"redwood", WriteRedwood, "seq", "color/00001.jpg", "depth/00001.png", "color/00002.jpg",
       "depth/00002.png"},
  };
}

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

}  // namespace vismap
