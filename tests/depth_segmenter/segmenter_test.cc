#include "depth_segmenter/segmenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "rectify/rectified_camera.h"
#include "rectify/rectifier.h"
#include "support/messages.h"
#include "wire/rgbd_frame.h"
#include "wire/segmented_frame.h"

// A whole depth segmenter, on a bus of its own.

namespace vismap {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A wall with every third row and column missing.
SensorFrame WallWithHoles(int64_t utime) {
  SensorFrame frame = SmallSensorFrame(utime);
  for (int v = 0; v < frame.depth.height(); ++v) {
    for (int u = 0; u < frame.depth.width(); ++u)
      frame.depth(v, u) = v % 3 == 0 || u % 3 == 0 ? 0 : 1500;
  }
  return frame;
}

class SegmenterOnABus : public ::testing::Test {
 protected:
  SegmenterOnABus() {
    bus_->Subscribe<segmented_frame_t>(
        kSegmentedFrameChannel,
        [this](const segmented_frame_t& message) { answers_.push_back(message); });
    options_.detections = WaitForDetections::kNone;
  }

  void SendFrames(int count) {
    Segmenter segmenter(options_, stage_, &context_);
    for (int i = 1; i <= count; ++i) {
      bus_->Publish(kRgbdFrameChannel, Encode(WallWithHoles(1000 * i)));
      while (bus_->Spin(0)) {
      }
    }
  }

  std::unique_ptr<Bus> bus_ = std::move(*Bus::Open({"memq://", "test"}));
  Status status_{bus_.get(), "depth-segmenter"};
  CommonOptions common_;
  StopSignal stop_;
  ServiceManager service_;
  ProcessContext context_{common_, stop_, service_, bus_.get(), &status_};
  DepthSegmenterOptions options_;
  SegmentationStageOptions stage_;
  std::vector<segmented_frame_t> answers_;
};

TEST_F(SegmenterOnABus, FillsHolesForItselfAndPassesOnTheMeasuredDepth) {
  SendFrames(8);
  ASSERT_EQ(answers_.size(), 8u);
  const rgbd_frame_t sent = Encode(WallWithHoles(1000));
  EXPECT_EQ(answers_[0].frame.depth, sent.depth);
  const Result<SegmentedFrame> frame = Decode(answers_[0]);
  ASSERT_TRUE(frame) << frame.error().message;
  ASSERT_EQ(frame->segments.size(), 1u);
  // The first row and column, and the last column, are holes at the border of the image.
  EXPECT_EQ(frame->segments[0].pixels, 62 * 47);
  EXPECT_THAT(status_.findings(), IsEmpty());
}

TEST_F(SegmenterOnABus, TellsThatHardlyAnyDepthLiesInSegmentsAndWhy) {
  stage_.surface.max_hole_px = 0;
  SendFrames(8);
  EXPECT_THAT(status_.findings(),
              ElementsAre(AllOf(HasSubstr("only 0 % of the pixels with depth lie in segments"),
                                HasSubstr("beside a hole"), HasSubstr("max_hole_px"))));
}

TEST_F(SegmenterOnABus, TakesOutSaturatedDepthForAllThatFollowsAndTellsHowMuch) {
  SensorFrame frame = WallWithHoles(1000);
  for (int v = 10; v < 40; ++v) {
    for (int u = 10; u < 50; ++u) frame.depth(v, u) = 8000;
  }
  Segmenter segmenter(options_, stage_, &context_);
  bus_->Publish(kRgbdFrameChannel, Encode(frame));
  while (bus_->Spin(0)) {
  }
  ASSERT_EQ(answers_.size(), 1u);
  const Result<SensorFrame> passed_on = Decode(answers_[0].frame);
  ASSERT_TRUE(passed_on) << passed_on.error().message;
  EXPECT_EQ(passed_on->depth(20, 20), 0);
  EXPECT_EQ(passed_on->depth(1, 1), 1500);
  EXPECT_EQ(answers_[0].frame.utime, 1000);
  EXPECT_EQ(status_.counter("pixels_saturated"), 1200);
  EXPECT_THAT(status_.findings(),
              ElementsAre(AllOf(HasSubstr("of the pixels have exactly the same depth, 8 m"),
                                HasSubstr("drop_saturated"))));
}

// Raw colour and depth, seen through a lens.
rgbd_frame_t FrameOfALens(int64_t utime) {
  SensorFrame frame = SmallSensorFrame(utime);
  FrameOptics optics;
  optics.color = {kSmallCamera, Distortion::kBrownConrady, {-0.1, 0.02, 0, 0}};
  EXPECT_TRUE(SetOptics(optics, true, &frame));
  frame.color.assign(3 * frame.depth.size(), 100);
  frame.color_encoding = ColorEncoding::kRgb;
  return Encode(frame);
}

TEST_F(SegmenterOnABus, RectifiesAFrameAndRepeatsTheAnswer) {
  Segmenter segmenter(options_, stage_, &context_);
  rgbd_frame_t sent = FrameOfALens(1000);
  for (const int64_t after : {-1, 500}) {
    sent.after_utime = after;
    bus_->Publish(kRgbdFrameChannel, sent);
    while (bus_->Spin(0)) {
    }
  }
  ASSERT_EQ(answers_.size(), 2u);
  EXPECT_EQ(status_.counter("frames"), 1) << "the second one is the same frame";
  EXPECT_EQ(answers_[1].frame.after_utime, 500);
  Rectifier rectifier;
  const SensorFrame expected = *rectifier.Rectify(*Decode(sent));
  for (const segmented_frame_t& answer : answers_) {
    const Result<SensorFrame> frame = Decode(answer.frame);
    ASSERT_TRUE(frame) << frame.error().message;
    EXPECT_FALSE(frame->optics);
    EXPECT_EQ(frame->depth, expected.depth);
    EXPECT_EQ(frame->color, expected.color);
    EXPECT_EQ(answer.frame.source, "test");
  }
}

TEST_F(SegmenterOnABus, ACameraThatIsImpossibleIsLeftOutAndTold) {
  Segmenter segmenter(options_, stage_, &context_);
  rgbd_frame_t sent = FrameOfALens(1000);
  sent.color_camera.coefficients[0] = -0.9;
  bus_->Publish(kRgbdFrameChannel, sent);
  while (bus_->Spin(0)) {
  }
  EXPECT_THAT(answers_, IsEmpty());
  EXPECT_THAT(status_.findings(),
              ElementsAre(AllOf(HasSubstr("1 of 1 frames"), HasSubstr("color_camera"),
                                HasSubstr("the distortion folds"))));
}

}  // namespace
}  // namespace vismap
