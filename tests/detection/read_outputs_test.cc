#include "detection/read_outputs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "detection/yolo_head.h"

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const ClassTable kClasses = {ClassId{62}, ClassId::kUnknown, ClassId{47}};
constexpr int kCoefficients = 2;

/// One row of a head: a box in input pixels, its class with the score, its mask coefficients.
struct Row {
  float cx, cy, w, h;
  int class_index;
  float score;
  float first = 1, second = 0;
};

enum class Order { kFeaturesFirst, kRowsFirst };

/// A head with these rows.
Tensor Head(const std::vector<Row>& rows, bool objectness, Order order) {
  std::vector<std::vector<float>> table;
  for (const Row& row : rows) {
    std::vector<float> features = {row.cx, row.cy, row.w, row.h};
    if (objectness) features.push_back(0.5f);
    for (int index = 0; index < static_cast<int>(kClasses.size()); ++index)
      features.push_back(index == row.class_index ? row.score : 0.01f);
    features.push_back(row.first);
    features.push_back(row.second);
    table.push_back(features);
  }
  const int count = static_cast<int>(rows.size()), size = static_cast<int>(table[0].size());
  const bool first = order == Order::kFeaturesFirst;
  Tensor head{first ? std::vector{1, size, count} : std::vector{1, count, size}, {}};
  for (int i = 0; i < (first ? size : count); ++i) {
    for (int j = 0; j < (first ? count : size); ++j) {
      head.values.push_back(
          table[static_cast<size_t>(first ? j : i)][static_cast<size_t>(first ? i : j)]);
    }
  }
  return head;
}

/// Prototypes of an input of 64 x 64: the first is high in the left half, the second in the upper
/// half.
Tensor HalfPrototypes() {
  constexpr int kCells = 16;
  Tensor prototypes{{1, kCoefficients, kCells, kCells}, {}};
  for (int v = 0; v < kCells; ++v) {
    for (int u = 0; u < kCells; ++u) prototypes.values.push_back(u < kCells / 2 ? 10.0f : -10.0f);
  }
  for (int v = 0; v < kCells; ++v) {
    for (int u = 0; u < kCells; ++u) prototypes.values.push_back(v < kCells / 2 ? 10.0f : -10.0f);
  }
  return prototypes;
}

std::vector<Detection> Read(const Tensor& head, const Letterbox& letterbox,
                            const DnnDetectorOptions& options = {}) {
  const auto detections = YoloDetections({head, HalfPrototypes()}, letterbox, kClasses, options);
  EXPECT_TRUE(detections) << detections.error().message;
  return detections.value_or(std::vector<Detection>{});
}

size_t Count(const Mask& mask) {
  return static_cast<size_t>(
      std::count(mask.inside.pixels().begin(), mask.inside.pixels().end(), 1));
}

const Letterbox kSame = FitLetterbox(64, 64, 64, 64);

TEST(YoloDetections, OneBoxWithItsHalfMaskInEveryLayout) {
  for (const bool objectness : {false, true}) {
    for (const Order order : {Order::kFeaturesFirst, Order::kRowsFirst}) {
      const auto found = Read(Head({{32, 32, 40, 20, 2, 0.9f}}, objectness, order), kSame);
      ASSERT_THAT(found, SizeIs(1));
      EXPECT_EQ(found[0].class_id, ClassId{47});
      EXPECT_FLOAT_EQ(found[0].score, objectness ? 0.45f : 0.9f);
      const Mask& mask = found[0].mask;
      EXPECT_EQ(mask.u0, 12) << "the left edge of the box";
      EXPECT_EQ(mask.v0, 22);
      EXPECT_EQ(mask.inside.width(), 20) << "up to the middle, where the prototype falls";
      EXPECT_EQ(mask.inside.height(), 20);
      EXPECT_EQ(Count(mask), 400u);
    }
  }
}

TEST(YoloDetections, LetterboxedMaskComesBackToTheImage) {
  // An image of 640x480 in an input of 64x64 is scaled by 1/10; the lower 16 rows are padding.
  const Letterbox letterbox = FitLetterbox(640, 480, 64, 64);
  EXPECT_EQ(letterbox.width, 64);
  EXPECT_EQ(letterbox.height, 48);
  const auto found =
      Read(Head({{32, 32, 64, 64, 0, 0.8f, 0, 1}}, false, Order::kFeaturesFirst), letterbox);
  ASSERT_THAT(found, SizeIs(1));
  const Mask& mask = found[0].mask;
  EXPECT_EQ(mask.image_width, 640);
  EXPECT_EQ(mask.image_height, 480);
  EXPECT_EQ(mask.u0, 0);
  EXPECT_EQ(mask.v0, 0);
  EXPECT_EQ(mask.inside.width(), 640);
  EXPECT_EQ(mask.inside.height(), 320) << "the upper half of the input, 32 rows";
}

TEST(YoloDetections, TallImagesAreToo) {
  const Letterbox letterbox = FitLetterbox(120, 240, 64, 64);
  EXPECT_EQ(letterbox.width, 32);
  const auto found =
      Read(Head({{8, 32, 16, 64, 0, 0.8f}}, false, Order::kFeaturesFirst), letterbox);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].mask.inside.width(), 60);
  EXPECT_EQ(found[0].mask.inside.height(), 240);
}

TEST(YoloDetections, OverlapsOfAClassLeaveTheStrongest) {
  const std::vector<Row> rows = {{20, 32, 20, 20, 0, 0.6f},
                                 {21, 32, 20, 20, 0, 0.9f},
                                 {20, 32, 20, 20, 2, 0.7f},   // another class
                                 {20, 50, 20, 20, 0, 0.5f}};  // elsewhere
  const auto found = Read(Head(rows, false, Order::kFeaturesFirst), kSame);
  ASSERT_THAT(found, SizeIs(3));
  EXPECT_FLOAT_EQ(found[0].score, 0.9f);
  EXPECT_EQ(found[1].class_id, ClassId{47});
  EXPECT_FLOAT_EQ(found[2].score, 0.5f);
  DnnDetectorOptions options;
  options.max_detections = 2;
  EXPECT_THAT(Read(Head(rows, false, Order::kFeaturesFirst), kSame, options), SizeIs(2));
  options.nms_iou = 0.95;
  options.max_detections = 100;
  EXPECT_THAT(Read(Head(rows, false, Order::kFeaturesFirst), kSame, options), SizeIs(4));
}

TEST(YoloDetections, WeakDroppedAndBrokenRowsAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(Read(Head({{32, 32, 20, 20, 0, 0.2f},   // below min_score
                         {32, 32, 20, 20, 1, 0.9f},   // a class that is to be dropped
                         {nan, 32, 20, 20, 0, 0.9f},  // no box
                         {32, 32, 20, 20, 0, nan},    // no score
                         {900, 32, 20, 20, 0, 0.9f},  // outside of the image
                         {50, 32, 20, 20, 0, 0.9f}},  // the mask is empty in this half
                        false, Order::kFeaturesFirst),
                   kSame),
              IsEmpty());
}

TEST(YoloDetections, WrongShapesAreNamed) {
  const auto error = [](std::vector<Tensor> outputs) {
    const auto found = YoloDetections(std::move(outputs), kSame, kClasses, {});
    EXPECT_FALSE(found);
    return found ? "" : found.error().message;
  };
  const Tensor head = Head({{1, 1, 1, 1, 0, 1}}, false, Order::kFeaturesFirst);
  EXPECT_THAT(error({}), HasSubstr("found nothing"));
  EXPECT_THAT(error({head}), AllOf(HasSubstr("1xFEATURESxROWS"), HasSubstr("found 1x9x1")));
  EXPECT_THAT(error({head, head, HalfPrototypes()}), HasSubstr("found 1x9x1 and 1x9x1 and 1x2x16"));
  Tensor more = head;
  more.shape = {1, 12, 1};
  more.values.resize(12);
  EXPECT_THAT(error({more, HalfPrototypes()}),
              AllOf(HasSubstr("the head is 1x12x1"), HasSubstr("9 (v8, v11) or 10 (v5)")));
}

/// Masks of Mask R-CNN, 4 x 4 for every class; only class 2 is high, in the left half.
Tensor ClassMasks(int count) {
  Tensor masks{{count, 3, 4, 4}, {}};
  for (int i = 0; i < count * 3; ++i) {
    for (int cell = 0; cell < 16; ++cell)
      masks.values.push_back(i % 3 == 2 && cell % 4 < 2 ? 1.0f : 0.0f);
  }
  return masks;
}

TEST(MaskRcnnDetections, MaskOfTheClassIsStretchedOverTheBox) {
  const Tensor found{{1, 1, 2, 7},
                     {0, 2, 0.9f, 0.25f, 0.5f, 0.75f, 1.0f,  //
                      0, 2, 0.1f, 0, 0, 1, 1}};
  const auto read = MaskRcnnDetections(found, ClassMasks(2), 160, 120, kClasses, {});
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_THAT(*read, SizeIs(1));
  const Detection& detection = (*read)[0];
  EXPECT_EQ(detection.class_id, ClassId{47});
  EXPECT_EQ(detection.mask.u0, 40);
  EXPECT_EQ(detection.mask.v0, 60);
  EXPECT_EQ(detection.mask.inside.width(), 40) << "half of the box";
  EXPECT_EQ(detection.mask.inside.height(), 60);
}

TEST(MaskRcnnDetections, ForeignClassesAreLeftOutAndWrongShapesNamed) {
  const Tensor found{{1, 1, 2, 7}, {0, 3, 0.9f, 0, 0, 1, 1, 0, -1, 0.9f, 0, 0, 1, 1}};
  const auto read = MaskRcnnDetections(found, ClassMasks(2), 160, 120, kClasses, {});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_THAT(*read, IsEmpty());
  const auto few = MaskRcnnDetections(found, ClassMasks(1), 160, 120, kClasses, {});
  ASSERT_FALSE(few);
  EXPECT_THAT(few.error().message, AllOf(HasSubstr("Nx3xHEIGHTxWIDTH"), HasSubstr("1x3x4x4")));
}

}  // namespace
}  // namespace vismap
