#include "geometry/depth_steps.h"

#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace vismap
