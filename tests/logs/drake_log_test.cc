#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "codecs/color_codec.h"
#include "logs/recording.h"
#include "support/temp_folder.h"

namespace vismap {
namespace {

Image<Rgb8> Stripes() {
  Image<Rgb8> image(16, 12);
  for (int v = 0; v < 12; ++v) {
    for (int u = 0; u < 16; ++u) image(v, u) = {static_cast<uint8_t>(16 * u), 90, 30};
  }
  return image;
}

/// A log that was written by another program than ours; see write_drake_log.py.
std::string DrakeLog(const TempFolder& folder) {
  folder.Write("color.jpg", EncodeJpeg(Stripes()));
  std::filesystem::create_directories(folder / "types");
  const std::string source = VISMAP_SOURCE_DIR, path = folder.path().string();
  const std::string types = std::string(LCM_GEN) + " --python --ppath " + path + "/types " +
                            source + "/lcmtypes/foreign/*.lcm";
  EXPECT_EQ(std::system(types.c_str()), 0) << types;
  const std::string write = "PYTHONDONTWRITEBYTECODE=1 python3 " + source +
                            "/tests/logs/write_drake_log.py " + path + "/types " + path +
                            "/drake.lcmlog " + path + "/color.jpg";
  EXPECT_EQ(std::system(write.c_str()), 0) << write;
  return path + "/drake.lcmlog";
}

TEST(DrakeLog, JpegColorAndPngDepthAreRead) {
  const TempFolder folder;
  AdapterOptions adapter;
  adapter.intrinsics = {20, 20, 7.5, 5.5};
  adapter.camera_frame = "wrist::camera";
  const Result<Recording> recording = OpenRecording(DrakeLog(folder), "", {}, adapter);
  ASSERT_TRUE(recording) << recording.error().message;
  const Dataset& dataset = *recording->dataset;
  ASSERT_EQ(dataset.size(), 5u);
  for (size_t k = 0; k < dataset.size(); ++k) {
    const Result<SensorFrame> frame = dataset.Read(k);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_EQ(frame->header.utime, 100'000 * static_cast<int64_t>(k));
    EXPECT_EQ(frame->color_encoding, ColorEncoding::kJpeg);
    EXPECT_EQ(frame->color, EncodeJpeg(Stripes()));
    const double seconds = 0.1 * static_cast<double>(k);
    Pose expected = Pose::Identity();
    expected.translation() = Eigen::Vector3d(0.5 * seconds, 1, 2);
    expected.linear() =
        Eigen::AngleAxisd(0.3 * seconds, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    EXPECT_TRUE(frame->header.T_W_C.isApprox(expected, 1e-6)) << k;
    for (int v = 0; v < 12; ++v) {
      for (int u = 0; u < 16; ++u) {
        const int depth = u == 3 ? 0 : u == 4 ? 65535 : 1000 + 10 * u + v + static_cast<int>(k);
        const bool none = depth == 0 || depth == 65535;
        if (none) {
          EXPECT_TRUE(frame->depth(v, u) == 0 || frame->depth(v, u) == 65535);
        } else {
          EXPECT_EQ(frame->depth(v, u), depth) << u << ", " << v;
        }
      }
    }
  }
}

}  // namespace
}  // namespace vismap
