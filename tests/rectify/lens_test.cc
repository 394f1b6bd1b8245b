#include "rectify/lens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "rectify/rectified_camera.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

const PinholeCamera kWide{640, 480, 320, 322, 318.7, 241.2};

// Each model with typical coefficients.
std::vector<LensCamera> Lenses() {
  return {{kWide},
          {kWide, Distortion::kBrownConrady, {-0.12, 0.05, 0.0008, -0.0005}},
          {kWide, Distortion::kBrownConrady, {0.05, -0.02, 0.001, 0.0005, 0.004}},
          {kWide, Distortion::kBrownConrady, {0.3, -0.05, 0.0003, -0.0002, 0.01, 0.35, -0.04, 0.004}},
          {kWide, Distortion::kEquidistant, {-0.01, 0.004, -0.003, 0.0006}}};
}

TEST(Lens, UndistortInvertsDistort) {
  for (const LensCamera& lens : Lenses()) {
    EXPECT_TRUE(CheckLens(lens));
    EXPECT_TRUE(CheckOneToOne(lens)) << CheckOneToOne(lens).error().message;
    for (int v = 0; v < 480; v += 37) {
      for (int u = 0; u < 640; u += 41) {
        const auto ray = Undistort(lens, Eigen::Vector2d(u, v));
        ASSERT_TRUE(ray) << u << " " << v;
        EXPECT_LE(ray->norm(), MaxRayRadius(lens));
        EXPECT_LT((Distort(lens, *ray) - Eigen::Vector2d(u, v)).norm(), 1e-6);
      }
    }
  }
}

// Written out for one point, with p1 and p2 in OpenCV's places.
TEST(Lens, BrownConradyHasOpenCvsOrder) {
  const LensCamera lens{
      kWide, Distortion::kBrownConrady, {0.1, 0.02, 0.003, -0.004, 0.005, 0.06, 0.007, 0.0008}};
  const double x = 0.3, y = -0.2, r2 = 0.13;
  const double radial = (1 + 0.1 * r2 + 0.02 * r2 * r2 + 0.005 * r2 * r2 * r2) /
                        (1 + 0.06 * r2 + 0.007 * r2 * r2 + 0.0008 * r2 * r2 * r2);
  const double dx = x * radial + 2 * 0.003 * x * y - 0.004 * (r2 + 2 * x * x);
  const double dy = y * radial + 0.003 * (r2 + 2 * y * y) - 2 * 0.004 * x * y;
  const Eigen::Vector2d expected(320 * dx + 318.7, 322 * dy + 241.2);
  EXPECT_LT((Distort(lens, {x, y}) - expected).norm(), 1e-9);
}

TEST(Lens, FisheyeWithoutCoefficientsIsProportionalToTheAngle) {
  const LensCamera lens{kWide, Distortion::kEquidistant, {0, 0, 0, 0}};
  EXPECT_FALSE(IsPinhole(lens));
  EXPECT_NEAR(Distort(lens, {1, 0}).x(), 318.7 + 320 * std::atan(1.0), 1e-9);
  EXPECT_TRUE(IsPinhole({kWide, Distortion::kBrownConrady, {0, 0, 0, 0}}));
}

TEST(Lens, DistortionThatFoldsWithinTheImageIsAnError) {
  const LensCamera barrel{kWide, Distortion::kBrownConrady, {-0.4, 0, 0, 0}};
  ASSERT_FALSE(CheckOneToOne(barrel));
  EXPECT_THAT(CheckOneToOne(barrel).error().message,
              HasSubstr("the distortion folds within the image near pixel"));
  LensCamera narrow = barrel;  // the same lens before a smaller part of its image
  narrow.pinhole.fx = narrow.pinhole.fy = 900;
  EXPECT_TRUE(CheckOneToOne(narrow));
  const LensCamera fisheye{kWide, Distortion::kEquidistant, {-0.5, 0, 0, 0}};
  EXPECT_THAT(CheckOneToOne(fisheye).error().message, HasSubstr("640x480"));
}

FrameOptics Unregistered() {
  FrameOptics optics;
  optics.color = {{1280, 720, 912, 911, 645.2, 362.4}};
  optics.depth = {{848, 480, 425, 425, 424.3, 238.9}};
  optics.depth_registered = false;
  return optics;
}

TEST(RectifiedCamera, HasAboutOnePixelForEachPixelOfDepth) {
  const PinholeCamera camera = RectifiedCamera(Unregistered(), true);
  EXPECT_EQ(camera.width, 597);
  EXPECT_EQ(camera.height, 336);
  EXPECT_NEAR(camera.fx, 425, 1);
  // The corners of the image see the same.
  const PinholeCamera color = Unregistered().color.pinhole;
  EXPECT_NEAR((-0.5 - camera.cx) / camera.fx, (-0.5 - color.cx) / color.fx, 1e-12);
  EXPECT_NEAR((camera.height - 0.5 - camera.cy) / camera.fy,
              (color.height - 0.5 - color.cy) / color.fy, 1e-12);
}

TEST(RectifiedCamera, IsNeverLargerThanTheColourImage) {
  FrameOptics optics = Unregistered();
  optics.depth.pinhole.fx = optics.depth.pinhole.fy = 2000;
  EXPECT_EQ(RectifiedCamera(optics, true), optics.color.pinhole);
  optics.depth_registered = true;
  EXPECT_EQ(RectifiedCamera(optics, true), optics.color.pinhole);
  EXPECT_EQ(RectifiedCamera(optics, false), optics.depth.pinhole);
}

TEST(CheckOptics, LooksOnlyAtWhatIsUsed) {
  FrameOptics optics = Unregistered();
  EXPECT_TRUE(CheckOptics(optics, true));
  optics.color = {};
  EXPECT_TRUE(CheckOptics(optics, false));
  EXPECT_THAT(CheckOptics(optics, true).error().message, HasSubstr("color_camera: camera size"));
  optics = Unregistered();
  optics.depth = {};
  EXPECT_THAT(CheckOptics(optics, true).error().message, HasSubstr("depth_camera: camera size"));
  optics.depth_registered = true;
  EXPECT_TRUE(CheckOptics(optics, true));
}

TEST(CheckOptics, RefusesAnImpossibleBaseline) {
  FrameOptics optics = Unregistered();
  optics.T_color_depth.translation().x() = 14.8;  // [mm], not [m]
  EXPECT_THAT(CheckOptics(optics, true).error().message,
              HasSubstr("T_color_depth: the cameras are 14.8"));
  optics.T_color_depth.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(CheckOptics(optics, true).error().message, HasSubstr("T_color_depth"));
  optics.T_color_depth = Pose::Identity();
  optics.T_color_depth.linear()(0, 0) = -1;
  EXPECT_THAT(CheckOptics(optics, true).error().message, HasSubstr("T_color_depth"));
}

TEST(SetOptics, AFrameOfAnIdealCameraNeedsNoRectification) {
  SensorFrame frame;
  FrameOptics optics;
  optics.color = {kWide, Distortion::kBrownConrady, {0, 0, 0, 0, 0}};
  ASSERT_TRUE(SetOptics(optics, true, &frame));
  EXPECT_FALSE(frame.optics);
  EXPECT_EQ(frame.header.camera, kWide);
  ASSERT_TRUE(SetOptics(Unregistered(), true, &frame));
  EXPECT_TRUE(frame.optics);
  EXPECT_EQ(frame.header.camera, RectifiedCamera(Unregistered(), true));
  optics.color.coefficients[0] = 0.01;
  optics.color.pinhole = {3000, 2000, 3000, 3000, 1500, 1000};
  EXPECT_THAT(SetOptics(optics, true, &frame).error().message, HasSubstr("6000000 pixels"));
}

}  // namespace
}  // namespace vismap
