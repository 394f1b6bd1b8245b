#include "detection/dnn_detector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_folder.h"
#include "support/tiny_onnx.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The tiny model and its class names in a folder.
class TinyModel {
 public:
  explicit TinyModel(const TinyYolo& yolo = {}) {
    folder_.Write("tiny.onnx", yolo.Model());
    folder_.Write("names.txt", TinyYolo::ClassNames());
  }
  DnnDetectorOptions Options() const {
    DnnDetectorOptions options;
    options.model = (folder_ / "tiny.onnx").string();
    options.class_names = (folder_ / "names.txt").string();
    return options;
  }

 private:
  TempFolder folder_;
};

/// 128 x 96, grey, with a red rectangle at u in [32, 80), v in [16, 64).
Image<Rgb8> RedThing() {
  Image<Rgb8> image(128, 96, {90, 90, 90});
  for (int v = 16; v < 64; ++v) {
    for (int u = 32; u < 80; ++u) image(v, u) = {255, 0, 0};
  }
  return image;
}

DetectionSet Seen(const DnnDetectorOptions& options, const Image<Rgb8>& image) {
  auto detector = DnnDetector::Load(options);
  EXPECT_TRUE(detector) << detector.error().message;
  if (!detector) return {};
  FrameHeader header;
  header.utime = 7;
  header.camera_id = CameraId{2};
  header.frame_number = 5;
  const Result<DetectionSet> set = (*detector)->Detect(image, header);
  EXPECT_TRUE(set) << set.error().message;
  return set.value_or(DetectionSet{});
}

std::string ErrorOf(const DnnDetectorOptions& options) {
  const auto detector = DnnDetector::Load(options);
  EXPECT_FALSE(detector);
  return detector ? "" : detector.error().message;
}

void ExpectTheRedThing(const DetectionSet& set, float score) {
  EXPECT_EQ(set.utime, 7);
  EXPECT_EQ(set.camera_id, CameraId{2});
  EXPECT_EQ(set.frame_number, 5);
  ASSERT_EQ(set.detections.size(), 1u) << "overlaps are suppressed";
  const Detection& found = set.detections[0];
  EXPECT_EQ(found.class_id, ClassId{62}) << "chair";
  EXPECT_NEAR(found.score, score, 1e-4);
  EXPECT_EQ(found.mask.image_width, 128);
  EXPECT_EQ(found.mask.image_height, 96);
  EXPECT_NEAR(found.mask.u0, 32, 2);
  EXPECT_NEAR(found.mask.v0, 16, 2);
  EXPECT_NEAR(found.mask.inside.width(), 48, 4);
  EXPECT_NEAR(found.mask.inside.height(), 48, 4);
  EXPECT_TRUE(found.mask.Contains(40, 56));
  EXPECT_FALSE(found.mask.Contains(80, 56));
}

TEST(DnnDetector, FindsTheRedThingInEveryLayoutOfTheHead) {
  for (const bool objectness : {false, true}) {
    for (const bool features_last : {false, true}) {
      const TinyModel model({.objectness = objectness, .features_last = features_last});
      ExpectTheRedThing(Seen(model.Options(), RedThing()), objectness ? 0.9f : 1.0f);
    }
  }
}

TEST(DnnDetector, SameImageSameDetectionsWithAnyNumberOfThreads) {
  const TinyModel model;
  DnnDetectorOptions options = model.Options();
  options.threads = 1;
  const DetectionSet one = Seen(options, RedThing());
  options.threads = 0;
  const DetectionSet all = Seen(options, RedThing());
  ASSERT_EQ(one.detections.size(), all.detections.size());
  EXPECT_EQ(one.detections[0].mask, all.detections[0].mask);
  EXPECT_EQ(one.detections[0].score, all.detections[0].score);
}

TEST(DnnDetector, NothingRedIsAnEmptySet) {
  const TinyModel model;
  EXPECT_TRUE(Seen(model.Options(), Image<Rgb8>(64, 64, {0, 200, 0})).detections.empty());
}

TEST(DnnDetector, LoadSaysWhatIsWrong) {
  const TinyModel model;
  const TempFolder folder;
  folder.Write("text.onnx", "this is no network");
  folder.Write("text.pb", "nor is this");
  folder.Write("four.txt", "chair\ncup\n900 robot\n-\n");
  DnnDetectorOptions options = model.Options();
  options.model = (folder / "none.onnx").string();
  EXPECT_THAT(ErrorOf(options), AllOf(HasSubstr("none.onnx"), HasSubstr("no such file")));
  options.model = (folder / "text.onnx").string();
  EXPECT_THAT(ErrorOf(options), AllOf(HasSubstr("text.onnx"), HasSubstr("cannot be read")));
  options.model = (folder / "text.pb").string();
  EXPECT_THAT(ErrorOf(options), AllOf(HasSubstr("text.pb"), HasSubstr("cannot be read")));
  options.graph = (folder / "none.pbtxt").string();
  EXPECT_THAT(ErrorOf(options), HasSubstr("none.pbtxt: no such file"));
  std::filesystem::resize_file(folder / "text.onnx", uintmax_t{1} << 40);  // a sparse file
  options = model.Options();
  options.model = (folder / "text.onnx").string();
  EXPECT_THAT(ErrorOf(options), HasSubstr("text.onnx: expected a network of at most"));
  options = model.Options();
  options.class_names = (folder / "four.txt").string();
  EXPECT_THAT(ErrorOf(options),
              AllOf(HasSubstr("the head is 1x8x64"), HasSubstr("10 (v8, v11) or 11 (v5)")));
}

TEST(DnnDetector, OutputsOfAnotherNetworkAreNamed) {
  const TinyModel model({.prototypes = false});
  EXPECT_THAT(
      ErrorOf(model.Options()),
      AllOf(HasSubstr("tiny.onnx: expected a YOLO segmentation head"), HasSubstr("found 1x8x64")));
  const TinyModel yolo;
  DnnDetectorOptions options = yolo.Options();
  options.kind = DnnModelKind::kMaskRcnn;
  EXPECT_THAT(ErrorOf(options),
              HasSubstr("expected an output detection_out_final, found output0, output1"));
  options = yolo.Options();
  options.input_size_px = 50;
  EXPECT_THAT(ErrorOf(options), HasSubstr("tiny.onnx: the network cannot be run: OpenCV says"));
  options.model = "model.bin";
  options.input_size_px = 0;
  EXPECT_THAT(ErrorOf(options), HasSubstr("expected .onnx (YOLO) or .pb (Mask R-CNN)"));
}

}  // namespace
}  // namespace vismap
