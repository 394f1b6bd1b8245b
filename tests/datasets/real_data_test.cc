// The sequences under the folder that the environment variable VISMAP_DATA names.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <ostream>

#include "codecs/frame_codec.h"
#include "codecs/mask_codec.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"

namespace vismap {
namespace {

struct Expected {
  const char* folder;
  const char* format;
  size_t frames;
  int64_t first_number, last_number;
  PinholeCamera camera;
  int64_t detections;  ///< -1 = no file
};

/// Names the case by its folder.
void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.folder; }

class RealData : public ::testing::TestWithParam<Expected> {
 protected:
  void SetUp() override {
    const char* root = std::getenv("VISMAP_DATA");
    if (root == nullptr) GTEST_SKIP() << "VISMAP_DATA is not set: no real data to test with";
    path_ = (std::filesystem::path(root) / GetParam().folder).string();
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << path_ << " does not exist";
  }
  std::string path_;
};

TEST_P(RealData, OpensAndDecodes) {
  const Expected& expected = GetParam();
  const auto opened = OpenDataset(path_, "");
  ASSERT_TRUE(opened) << opened.error().message;
  const Dataset& dataset = **opened;
  EXPECT_EQ(dataset.format(), expected.format);
  ASSERT_EQ(dataset.size(), expected.frames);
  EXPECT_TRUE(dataset.skipped().empty());
  EXPECT_EQ(dataset.Header(0).frame_number, expected.first_number);
  EXPECT_EQ(dataset.Header(expected.frames - 1).frame_number, expected.last_number);
  EXPECT_EQ(dataset.Header(0).camera, expected.camera);
  for (size_t i = 0; i < dataset.size(); i += 1 + dataset.size() / 8) {
    const Result<SensorFrame> frame = dataset.Read(i);
    ASSERT_TRUE(frame) << frame.error().message;
    const Result<RgbdFrame> decoded = DecodeFrame(*frame);
    ASSERT_TRUE(decoded) << decoded.error().message;
    int in_a_room = 0;
    for (const float z : decoded->depth.pixels()) in_a_room += z > 0.2f && z < 14.0f ? 1 : 0;
    EXPECT_GT(in_a_room, static_cast<int>(decoded->depth.size() / 2)) << "frame " << i;
  }
}

TEST_P(RealData, AllItsDetectionsAreFoundByItsFrames) {
  const Expected& expected = GetParam();
  const auto dataset = OpenDataset(path_, "");
  ASSERT_TRUE(dataset) << dataset.error().message;
  const auto path = (*dataset)->default_detections_path();
  ASSERT_EQ(path.has_value(), expected.detections >= 0);
  if (!path) return;
  const auto source = LoadDetections(*path);
  ASSERT_TRUE(source) << source.error().message;
  int64_t found = 0;
  for (size_t i = 0; i < (*dataset)->size(); ++i) {
    const Result<DetectionSet> set = (*source)->ForFrame((*dataset)->Header(i));
    ASSERT_TRUE(set) << set.error().message;
    found += static_cast<int64_t>(set->detections.size());
    for (const Detection& detection : set->detections) {
      const Result<MaskRuns> again = RunsFromString(RunsToString(EncodeMask(detection.mask)));
      ASSERT_TRUE(again);
      EXPECT_EQ(*DecodeMask(*again, detection.mask.image_width, detection.mask.image_height),
                detection.mask);
    }
  }
  EXPECT_EQ(found, expected.detections);
}

constexpr PinholeCamera kAsus{640, 480, 544.47, 544.47, 320, 240};

INSTANTIATE_TEST_SUITE_P(
    All, RealData,
    ::testing::Values(
        Expected{"scenes/101", "scenenn", 120, 1, 120, kAsus, 301},
        Expected{"scenes/102", "scenenn", 80, 1, 80, kAsus, 170},
        Expected{"replica/r1", "scenenn", 120, 1, 120, {512, 512, 256, 256, 255.5, 255.5}, 244},
        Expected{"7scenes", "7scenes", 200, 0, 398, {640, 480, 525, 525, 320, 240}, 655},
        Expected{"tum_fr1_rpy", "tum", 15, 0, 14, {640, 480, 525, 525, 319.5, 239.5}, -1},
        Expected{"redwood5", "redwood", 5, 0, 4, {640, 480, 525, 525, 319.5, 239.5}, -1}));

}  // namespace
}  // namespace vismap
