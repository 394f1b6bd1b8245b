#include "geometry/smooth_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "support/analytic_depth.h"
#include "support/naive/smooth_depth.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::RandomNumbers;

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

Image<float> Wall(const Eigen::Vector3d& normal, double offset) {
  return Render({.planes = {{normal.normalized(), offset}}, .spheres = {}}, kVga).depth;
}

/// Root mean square of the difference where both have depth [m].
double Deviation(const Image<float>& a, const Image<float>& b) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < a.pixels().size(); ++i) {
    const double gap = static_cast<double>(a.data()[i]) - static_cast<double>(b.data()[i]);
    if (std::isnan(gap)) continue;
    sum += gap * gap;
    ++count;
  }
  return std::sqrt(sum / count);
}

TEST(SmoothDepth, EqualsTheNaiveOne) {
  for (const auto& [width, height] : testing_support::kOddSizes) {
    for (uint64_t seed = 1; seed <= 4; ++seed) {
      RandomNumbers random(seed);
      const PinholeCamera camera = testing_support::RandomCamera(width, height, &random);
      const Image<float> depth = testing_support::RandomDepth(camera, &random);
      const DepthNoiseModel noise = seed % 2 == 0 ? RealSenseNoise() : KinectNoise();
      const DepthSmoothing options{.radius_px = random.Whole(0, kMostSmoothRadius),
                                   .sigmas = random.Real(0.5, 4)};
      const Image<float> fast = SmoothDepth(depth, noise, options);
      const Image<float> slow = naive::SmoothDepth(depth, noise, options);
      EXPECT_TRUE(std::ranges::equal(fast.pixels(), slow.pixels(),
                                     [](float a, float b) {
                                       return std::bit_cast<uint32_t>(a) ==
                                                  std::bit_cast<uint32_t>(b) ||
                                              (std::isnan(a) && std::isnan(b));
                                     }))
          << width << "x" << height << ", seed " << seed;
    }
  }
}

TEST(SmoothDepth, PlanesStayWhatTheyAreAtAnySlant) {
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0.6), Eigen::Vector3d(0.3, 0.8, 0.4)}) {
    const Image<float> depth = Wall(normal, 1.5);
    EXPECT_LT(Deviation(SmoothDepth(depth, KinectNoise(), {}), depth), 2e-5);
  }
}

TEST(SmoothDepth, AKinectsNoiseAndStepsBecomeLessThanHalf) {
  for (const double z : {1.0, 2.0, 3.0, 4.0}) {
    const Image<float> exact = Wall({0.2, 0.1, 1}, z);
    const Image<float> noisy = AddNoise(exact, KinectNoise(), 3, 1);
    const Image<float> smooth = SmoothDepth(noisy, KinectNoise(), {});
    EXPECT_LT(Deviation(smooth, exact), 0.5 * Deviation(noisy, exact)) << z;
  }
}

TEST(SmoothDepth, EdgesHolesAndThinThingsStayWhatTheyAre) {
  Image<float> depth(40, 30, 2.0F);
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 12; ++u) depth(v, u) = 1.5F;  // a step
    depth(v, 25) = 1.6F;                              // a post of one pixel
  }
  depth(15, 35) = kHole;
  const Image<float> smooth = SmoothDepth(depth, KinectNoise(), {});
  EXPECT_TRUE(std::isnan(smooth(15, 35)));
  for (int v = 0; v < 30; ++v) {
    for (int u = 0; u < 40; ++u) {
      if (v == 15 && u == 35) continue;
      EXPECT_NEAR(smooth(v, u), depth(v, u), 1e-5) << v << " " << u;
    }
  }
}

TEST(SmoothDepth, RadiusZeroIsTheDepthAsMeasured) {
  const Image<float> depth = AddNoise(Wall({0, 0, 1}, 2), KinectNoise(), 3, 1);
  EXPECT_EQ(Deviation(SmoothDepth(depth, KinectNoise(), {.radius_px = 0}), depth), 0);
}

}  // namespace
}  // namespace vismap
