// The model and the sequence under the folder that the environment variable VISMAP_DATA names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "codecs/frame_codec.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "detection/dnn_detector.h"

namespace vismap {
namespace {

double Overlap(const Mask& a, const Mask& b) {
  int both = 0, any = 0;
  for (int v = 0; v < a.image_height; ++v) {
    for (int u = 0; u < a.image_width; ++u) {
      const bool in_a = a.Contains(v, u), in_b = b.Contains(v, u);
      both += in_a && in_b ? 1 : 0;
      any += in_a || in_b ? 1 : 0;
    }
  }
  return any > 0 ? static_cast<double>(both) / any : 0;
}

class RealModel : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* root = std::getenv("VISMAP_DATA");
    if (root == nullptr) GTEST_SKIP() << "VISMAP_DATA is not set: no real model to test with";
    const std::filesystem::path data(root);
    options_.model = (data / "models" / "yolov8n-seg_320.onnx").string();
    options_.min_score = 0.35;  // as the recorded detections have it
    sequence_ = (data / "7scenes").string();
    for (const std::string& path : {options_.model, sequence_}) {
      if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " does not exist";
    }
  }
  DnnDetectorOptions options_;
  std::string sequence_;
};

TEST_F(RealModel, SeesAChairAndWhatWasRecordedOfTheSameModel) {
  const auto detector = DnnDetector::Load(options_);
  ASSERT_TRUE(detector) << detector.error().message;
  const auto dataset = OpenDataset(sequence_, "");
  ASSERT_TRUE(dataset) << dataset.error().message;
  const auto recorded = LoadDetections(*(*dataset)->default_detections_path());
  ASSERT_TRUE(recorded) << recorded.error().message;
  int expected = 0, agreeing = 0, found = 0, chairs = 0;
  for (size_t i = 0; i < (*dataset)->size(); i += 25) {
    const auto frame = DecodeFrame(*(*dataset)->Read(i));
    ASSERT_TRUE(frame) << frame.error().message;
    const auto seen = (*detector)->Detect(frame->color, frame->header);
    ASSERT_TRUE(seen) << seen.error().message;
    const auto known = (*recorded)->ForFrame(frame->header);
    found += static_cast<int>(seen->detections.size());
    for (const Detection& detection : seen->detections)
      chairs += detection.class_id == ClassId{62} ? 1 : 0;
    for (const Detection& old : known->detections) {
      ++expected;
      const bool again = std::any_of(
          seen->detections.begin(), seen->detections.end(), [&](const Detection& detection) {
            return detection.class_id == old.class_id && Overlap(detection.mask, old.mask) > 0.8;
          });
      agreeing += again ? 1 : 0;
    }
  }
  EXPECT_GE(chairs, 1);
  EXPECT_GE(agreeing, expected * 8 / 10) << "of " << expected << " recorded, " << found << " found";
  RecordProperty("agreeing", agreeing);
  RecordProperty("expected", expected);
  RecordProperty("found", found);
}

TEST_F(RealModel, SeesTheSameWithAnyNumberOfThreads) {
  const auto dataset = OpenDataset(sequence_, "");
  ASSERT_TRUE(dataset) << dataset.error().message;
  const auto frame = DecodeFrame(*(*dataset)->Read(0));
  ASSERT_TRUE(frame) << frame.error().message;
  std::vector<DetectionSet> seen;
  for (const int threads : {1, 2, 0}) {
    options_.threads = threads;
    const auto detector = DnnDetector::Load(options_);
    ASSERT_TRUE(detector) << detector.error().message;
    seen.push_back(*(*detector)->Detect(frame->color, frame->header));
  }
  ASSERT_FALSE(seen[0].detections.empty());
  for (const DetectionSet& set : seen) {
    ASSERT_EQ(set.detections.size(), seen[0].detections.size());
    for (size_t i = 0; i < set.detections.size(); ++i) {
      EXPECT_EQ(set.detections[i].score, seen[0].detections[i].score);
      EXPECT_EQ(set.detections[i].mask, seen[0].detections[i].mask);
    }
  }
}

}  // namespace
}  // namespace vismap
