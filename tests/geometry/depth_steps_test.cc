#include "geometry/depth_steps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/analytic_depth.h"
#include "support/hole_patterns.h"

namespace vismap {
namespace {

/// JumpSigmas for a slanted wall, seen by a sensor that measures inverse depth in steps of this
/// many standard deviations.
double JumpSigmasOfSteps(double step_sigmas, int width = 320) {
  constexpr float kSigma = 0.0017F;
  const double step = step_sigmas * double{kSigma};
  Image<float> w(width, 240), sigma(width, 240, kSigma);
  for (int v = 0; v < w.height(); ++v) {
    for (int u = 0; u < w.width(); ++u) {
      const double exact = 0.5 + 0.15 * step * (u + 0.37 * v);
      w(v, u) = static_cast<float>(std::floor(exact / step) * step);
    }
  }
  return JumpSigmas(w, sigma, 5);
}

TEST(JumpSigmas, AreThoseOfTheModelForSensorsLikeIt) {
  EXPECT_EQ(JumpSigmasOfSteps(0.5), 5);
  EXPECT_EQ(JumpSigmasOfSteps(2), 5);
  EXPECT_EQ(JumpSigmasOfSteps(3.5), 5);
}

TEST(JumpSigmas, GrowWithTheStepsOfTheSensorUpToABound) {
  EXPECT_NEAR(JumpSigmasOfSteps(5.5), 1.3 * 5.5, 0.1);
  EXPECT_NEAR(JumpSigmasOfSteps(7), 1.3 * 7, 0.1);
  EXPECT_EQ(JumpSigmasOfSteps(50), 12.5);
}

TEST(JumpSigmas, AreThoseOfTheModelInImagesWithFewPixels) {
  EXPECT_EQ(JumpSigmasOfSteps(50, 24), 5);
}

TEST(JumpSigmas, AreNotRaisedByTheDepthJumpsOfThings) {
  Image<float> w(320, 240, 0.5F);
  const Image<float> sigma(320, 240, 0.0017F);
  for (int v = 0; v < w.height(); ++v) {
    for (int u = 0; u < w.width(); ++u) w(v, u) += u / 16 % 2 == 0 ? 0.0F : 0.2F;
  }
  EXPECT_EQ(JumpSigmas(w, sigma, 5), 5);
  EXPECT_EQ(JumpSigmas(Image<float>(320, 240), sigma, 5), 5) << "no depth";
}

DepthNoiseModel TimesNoisier(double factor) {
  DepthNoiseModel noise = KinectNoise();
  noise.axial_base_m *= factor;
  noise.axial_quadratic_per_m *= factor;
  noise.disparity_step_per_m *= factor;
  return noise;
}

TEST(BendAcrossHoles, IsThatOfTheNoiseWhateverHolesThereAre) {
  const Image<float> exact =
      Render({{{Eigen::Vector3d(0.3, -1, 0.6).normalized(), 1.5}}, {}}, kVga).depth;
  for (const double factor : {1.0, 3.0}) {
    const Image<float> noisy = AddNoise(exact, TimesNoisier(factor), 3, 2);
    const double whole = BendAcrossHoles(noisy, KinectNoise());
    EXPECT_NEAR(whole, 1.8 * factor, 0.4 * factor);
    for (const testing_support::HolePattern& pattern : testing_support::HolePatterns()) {
      const double bend =
          BendAcrossHoles(testing_support::WithHoles(noisy, pattern), KinectNoise());
      // The noise of pixels that are 3 or more apart is not correlated, so that they differ more.
      EXPECT_GT(bend, 0.8 * whole) << pattern.name << ", " << factor;
      EXPECT_LT(bend, 2 * whole) << pattern.name << ", " << factor;
    }
  }
}

TEST(BendAcrossHoles, IsNotRaisedByTheDepthJumpsOfThings) {
  Image<float> depth(320, 240, 2.0F);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) depth(v, u) -= u / 32 % 2 == 0 ? 0.0F : 0.5F;
  }
  EXPECT_LT(BendAcrossHoles(depth, KinectNoise()), 0.01);
}

TEST(BendAcrossHoles, IsZeroWithoutDepth) {
  EXPECT_EQ(BendAcrossHoles(Image<float>(320, 240), KinectNoise()), 0);
}

}  // namespace
}  // namespace vismap
