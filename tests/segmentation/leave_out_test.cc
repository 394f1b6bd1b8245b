#include "segmentation/leave_out.h"

#include <gtest/gtest.h>

#include <cmath>

#include "segmentation/segment_frame.h"

namespace vismap {
namespace {

constexpr ClassId kPerson{1}, kChair{62};

RgbdFrame Wall() {
  RgbdFrame frame;
  frame.header.camera = {640, 480, 525, 525, 319.5, 239.5};
  frame.depth = Image<float>(640, 480, 2.0F);
  return frame;
}

DetectionSet Seen(ClassId class_id, float score = 0.9F) {
  Detection detection{class_id, score, {640, 480, 300, 200, Image<uint8_t>(40, 60, uint8_t{1})}};
  return {0, CameraId{0}, 1, {detection}};
}

RefineOptions Options(int margin = 6) {
  RefineOptions options;
  options.leave_out_classes = {kPerson};
  options.leave_out_margin_px = margin;
  return options;
}

int64_t Holes(const RgbdFrame& frame) {
  int64_t holes = 0;
  for (const float depth : frame.depth.pixels()) holes += std::isnan(depth) ? 1 : 0;
  return holes;
}

TEST(LeaveOut, RemovesTheDepthOfTheMaskAndItsMargin) {
  RgbdFrame frame = Wall();
  EXPECT_EQ(LeaveOut(Seen(kPerson), Options(), &frame), (40 + 12) * (60 + 12));
  EXPECT_EQ(Holes(frame), (40 + 12) * (60 + 12));
  EXPECT_TRUE(std::isnan(frame.depth(200 - 6, 300 - 6)));
  EXPECT_TRUE(std::isnan(frame.depth(259 + 6, 339 + 6)));
  EXPECT_FALSE(std::isnan(frame.depth(200 - 7, 320)));
  EXPECT_FALSE(std::isnan(frame.depth(220, 339 + 7)));
}

TEST(LeaveOut, OtherClassesWeakDetectionsAndAnEmptyListRemoveNothing) {
  RgbdFrame frame = Wall();
  RefineOptions strict = Options();
  strict.min_score = 0.95;
  EXPECT_EQ(LeaveOut(Seen(kChair), Options(), &frame), 0);
  EXPECT_EQ(LeaveOut(Seen(kPerson), strict, &frame), 0);
  EXPECT_EQ(LeaveOut(Seen(kPerson), RefineOptions(), &frame), 0);
  EXPECT_EQ(Holes(frame), 0);
}

TEST(LeaveOut, MasksBeyondTheBorderAreCut) {
  RgbdFrame frame = Wall();
  DetectionSet set = Seen(kPerson);
  set.detections[0].mask.u0 = -20;
  set.detections[0].mask.v0 = 450;
  EXPECT_EQ(LeaveOut(set, Options(0), &frame), 20 * 30);
}

TEST(LeaveOut, SegmentsHaveNoPixelThereAndOthersKeepTheirDetections) {
  SegmentationStageOptions options;
  options.refine = Options();
  DetectionSet set = Seen(kPerson);
  set.detections.push_back(
      {kChair, 0.9F, {640, 480, 100, 100, Image<uint8_t>(80, 80, uint8_t{1})}});
  const SegmentedFrame frame = SegmentFrame(Wall(), &set, options);
  EXPECT_TRUE(frame.had_detections);
  for (int v = 194; v < 266; ++v) {
    for (int u = 294; u < 346; ++u) ASSERT_EQ(frame.image.index(v, u), SegmentIndex::kNone);
  }
  bool chair = false;
  for (const FrameSegment& segment : frame.segments) {
    EXPECT_NE(segment.class_id, kPerson);
    chair = chair || segment.class_id == kChair;
  }
  EXPECT_TRUE(chair);
}

}  // namespace
}  // namespace vismap
