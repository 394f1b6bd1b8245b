#include "geometry/saturated_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace vismap {
namespace {

constexpr int kWidth = 160, kHeight = 120;

/// A slanted floor-like surface from 1 m to 4 m, with noise of a deviation [m], in millimetres.
SensorFrame SlantedFrame(double deviation) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 1);
  SensorFrame frame;
  frame.depth = Image<uint16_t>(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      const double z = 1 / (1 - 0.75 * v / kHeight + 1e-4 * u);
      frame.depth(v, u) = static_cast<uint16_t>(std::lround(1e3 * (z + deviation * noise(random))));
    }
  }
  return frame;
}

/// Sets a rectangle of a frame to one value [mm].
void Paint(int u0, int v0, int width, int height, uint16_t value, SensorFrame* frame) {
  for (int v = v0; v < v0 + height; ++v) {
    for (int u = u0; u < u0 + width; ++u) frame->depth(v, u) = value;
  }
}

TEST(SaturatedDepth, OneFarValueOfManyPixelsIsNoReturnAndNothingElseChanges) {
  for (const double deviation : {0.0, 0.004}) {
    for (const uint16_t value : {uint16_t{8000}, uint16_t{6000}, uint16_t{10000}}) {
      SensorFrame frame = SlantedFrame(deviation);
      SensorFrame expected = frame;
      Paint(40, 30, 50, 40, value, &frame);
      Paint(40, 30, 50, 40, 0, &expected);
      const DepthLosses losses = DropSaturatedDepth({}, &frame);
      EXPECT_EQ(losses.saturated, 2000);
      EXPECT_NEAR(losses.saturated_m, 1e-3 * value, 1e-9);
      EXPECT_EQ(losses.pixels, kWidth * kHeight);
      EXPECT_EQ(frame.depth, expected.depth) << value;
    }
  }
}

TEST(SaturatedDepth, AFewPixelsOfAFarValueAreEnough) {
  SensorFrame frame = SlantedFrame(0.004);
  Paint(80, 20, 2, 2, 8123, &frame);
  EXPECT_EQ(DropSaturatedDepth({}, &frame).saturated, 4);
}

TEST(SaturatedDepth, ANearLargestValueIsNoReturnWhereTheImageIsNoisy) {
  SensorFrame noisy = SlantedFrame(0.004);
  Paint(40, 0, 50, 60, 4990, &noisy);
  EXPECT_EQ(DropSaturatedDepth({}, &noisy).saturated, 3000);
}

TEST(SaturatedDepth, AWallWithoutNoiseSeenHeadOnStays) {
  SensorFrame alone;
  alone.depth = Image<uint16_t>(kWidth, kHeight, 3000);
  EXPECT_EQ(DropSaturatedDepth({}, &alone).saturated, 0);

  SensorFrame beside = SlantedFrame(0);
  Paint(40, 0, 50, 60, 4990, &beside);  // through a door
  EXPECT_EQ(DropSaturatedDepth({}, &beside).saturated, 0);
  Paint(40, 0, 50, 60, 7321, &beside);
  EXPECT_EQ(DropSaturatedDepth({}, &beside).saturated, 0);
}

// The depth steps of a disparity sensor are so large there that most of a wall has one value.
TEST(SaturatedDepth, AFarWallOfACoarseDisparitySensorStays) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, KinectNoise().AxialSigma(7));
  SensorFrame frame = SlantedFrame(0.004);
  for (int v = 20; v < 60; ++v) {
    for (int u = 30; u < 90; ++u) {
      const double disparity = 1 / (0.00285 * (7 + noise(random)));
      frame.depth(v, u) =
          static_cast<uint16_t>(std::lround(1e3 / (0.00285 * std::round(disparity))));
    }
  }
  EXPECT_EQ(DropSaturatedDepth({}, &frame).saturated, 0);
}

TEST(SaturatedDepth, AFarWallWithoutNoiseThatItsSurroundingsLeadToStays) {
  SensorFrame frame;
  frame.depth = Image<uint16_t>(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {  // floor up to a wall at 7 m
    const double z = std::min(7.0, 1.5 * 130 / std::max(v - 40, 1));
    for (int u = 0; u < kWidth; ++u)
      frame.depth(v, u) = static_cast<uint16_t>(std::lround(1e3 * z));
  }
  // Left and right it ends at the image, above there is nothing, and below is the floor.
  EXPECT_EQ(DropSaturatedDepth({}, &frame).saturated, 0);
}

TEST(SaturatedDepth, DepthInMetresIsJudgedAlike) {
  SensorFrame frame = SlantedFrame(0.004);
  Paint(40, 30, 50, 40, 8000, &frame);
  frame.depth_m = Image<float>(kWidth, kHeight);
  for (size_t i = 0; i < frame.depth.size(); ++i)
    frame.depth_m.data()[i] = static_cast<float>(frame.depth.data()[i]) * 1e-3F;
  frame.depth = {};
  frame.depth_m(0, 0) = std::numeric_limits<float>::infinity();
  frame.depth_m(0, 1) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(DropSaturatedDepth({}, &frame).saturated, 2000);
  EXPECT_TRUE(std::isnan(frame.depth_m(35, 50)));
  EXPECT_FALSE(std::isnan(frame.depth_m(10, 10)));
}

TEST(SaturatedDepth, DepthOutsideOfTheLimitsIsCounted) {
  SensorFrame frame = SlantedFrame(0.004);
  Paint(0, 0, 10, 10, 12000, &frame);
  Paint(20, 0, 10, 5, 90, &frame);
  Paint(40, 0, 10, 5, 100, &frame);    // equal to the limit
  Paint(60, 0, 10, 5, 65535, &frame);  // no return
  const DepthLosses losses = DropSaturatedDepth({}, &frame);
  EXPECT_EQ(losses.too_far, 100);
  EXPECT_EQ(losses.too_near, 50);
  EXPECT_EQ(losses.saturated, 0);
  EXPECT_EQ(frame.depth(0, 0), 12000) << "PrepareDepth takes it out";
}

TEST(SaturatedDepth, CanBeTurnedOff) {
  SensorFrame frame = SlantedFrame(0.004);
  Paint(40, 30, 50, 40, 8000, &frame);
  SurfaceOptions options;
  options.drop_saturated = false;
  EXPECT_EQ(DropSaturatedDepth(options, &frame).saturated, 0);
  EXPECT_EQ(frame.depth(35, 50), 8000);
}

TEST(SaturatedDepth, FramesWithoutDepthAreFine) {
  SensorFrame frame;
  EXPECT_EQ(DropSaturatedDepth({}, &frame).pixels, 0);
  frame.depth = Image<uint16_t>(8, 8);
  EXPECT_EQ(DropSaturatedDepth({}, &frame).saturated, 0);
}

}  // namespace
}  // namespace vismap
