#include "geometry/fill_holes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/hole_kernels.h"
#include "support/analytic_depth.h"
#include "support/hole_patterns.h"
#include "support/naive/fill_holes.h"
#include "support/random_scenes.h"

namespace vismap {
namespace {

using testing_support::HolePattern;
using testing_support::HolePatterns;
using testing_support::RandomNumbers;
using testing_support::WithHoles;

constexpr float kNoDepth = std::numeric_limits<float>::quiet_NaN();
constexpr PinholeCamera kSmall{200, 150, 164, 164, 99.5, 74.5};

HoleOptions HolesOf(const DepthNoiseModel& noise, int max_px = 4) {
  HoleOptions options;
  options.noise = noise;
  options.max_px = max_px;
  return options;
}

Image<float> Filled(Image<float> depth, const HoleOptions& options = {}) {
  FillHoles(options, &depth);
  return depth;
}

bool SameBits(const Image<float>& a, const Image<float>& b) {
  return a.size() == b.size() &&
         std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin(),
                    [](float x, float y) { return x == y || (x != x && y != y); });
}

int CountHoles(const Image<float>& depth) {
  return static_cast<int>(std::count_if(depth.pixels().begin(), depth.pixels().end(),
                                        [](float z) { return std::isnan(z); }));
}

void CompareWithTheNaiveOne(int width, int height, uint64_t seed) {
  SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height) + ", seed " +
               std::to_string(seed));
  RandomNumbers random(seed);
  const PinholeCamera camera = testing_support::RandomCamera(width, height, &random);
  const std::vector<HolePattern> patterns = HolePatterns();
  const auto pattern = static_cast<size_t>(seed % patterns.size());
  const Image<float> depth =
      WithHoles(testing_support::RandomDepth(camera, &random), patterns[pattern]);
  const HoleOptions options =
      HolesOf(random.Chance(0.5) ? KinectNoise() : CleanNoise(), random.Whole(0, kMaxHolePx));
  EXPECT_TRUE(SameBits(Filled(depth, options), naive::FillHoles(depth, options)));
}

TEST(FillHoles, EqualsTheNaiveOneOnRandomScenesOfOddSizes) {
  for (const auto& [width, height] : testing_support::kOddSizes) {
    for (uint64_t seed = 1; seed <= 26; ++seed) CompareWithTheNaiveOne(width, height, seed);
  }
}

TEST(FillHoles, EqualsTheNaiveOneAroundTheUsualSize) {
  for (uint64_t seed = 1; seed <= 13; ++seed) CompareWithTheNaiveOne(641, 479, seed);
}

TEST(FillHoles, HolesOfEveryPatternInAPlaneGetThePlane) {
  for (const double slope : {0.0, 0.7, 2.5}) {
    const Eigen::Vector3d normal = Eigen::Vector3d(0.6 * slope, -slope, 1).normalized();
    const Image<float> exact = Render({{{normal, 1.2 / std::sqrt(1 + slope)}}, {}}, kSmall).depth;
    for (const HolePattern& pattern : HolePatterns()) {
      SCOPED_TRACE(pattern.name + ", slope " + std::to_string(slope));
      const Image<float> filled = Filled(WithHoles(exact, pattern), HolesOf(CleanNoise()));
      int holes = 0, pixels = 0;
      for (int v = 10; v < kSmall.height - 10; ++v) {
        for (int u = 10; u < kSmall.width - 10; ++u) {
          // Where the plane ends, there is no slope beyond one side.
          if (std::isnan(exact(v, u)) || std::isnan(exact(v - 10, u)) ||
              std::isnan(exact(v + 10, u)) || std::isnan(exact(v, u - 10)) ||
              std::isnan(exact(v, u + 10)))
            continue;
          ++pixels;
          if (std::isnan(filled(v, u))) {
            ++holes;
          } else {
            ASSERT_NEAR(filled(v, u), exact(v, u), 1e-5 * exact(v, u) * exact(v, u))
                << v << " " << u;
          }
        }
      }
      EXPECT_LT(holes, pattern.name == "half at random" ? 0.02 * pixels : 0.003 * pixels);
    }
  }
}

TEST(FillHoles, NoiseDoesNotKeepHolesOpen) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -1, 0.6).normalized();
  const Image<float> exact = Render({{{normal, 1.5}}, {}}, kVga).depth;
  const Image<float> noisy = AddNoise(exact, KinectNoise(), 3, 5);
  for (const HolePattern& pattern : HolePatterns()) {
    SCOPED_TRACE(pattern.name);
    const Image<float> punched = WithHoles(noisy, pattern);
    const int before = CountHoles(punched) - CountHoles(noisy);
    EXPECT_LT(CountHoles(Filled(punched)) - CountHoles(noisy), 0.03 * before);
  }
}

TEST(FillHoles, NoiseAboveTheModelDoesNotKeepHolesOpen) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.3, -1, 0.6).normalized();
  const Image<float> exact = Render({{{normal, 1.5}}, {}}, kVga).depth;
  DepthNoiseModel noise = KinectNoise();
  for (double* part :
       {&noise.axial_base_m, &noise.axial_quadratic_per_m, &noise.disparity_step_per_m})
    *part *= 3;
  const Image<float> noisy = AddNoise(exact, noise, 3, 5);
  for (const HolePattern& pattern : HolePatterns()) {
    SCOPED_TRACE(pattern.name);
    const Image<float> punched = WithHoles(noisy, pattern);
    const int before = CountHoles(punched) - CountHoles(noisy);
    EXPECT_LT(CountHoles(Filled(punched)) - CountHoles(noisy), 0.06 * before);
  }
}

// Two planes that face the camera, with a straight or a round border between them.
Image<float> Step(float near, float far, int kind) {
  Image<float> depth(kSmall.width, kSmall.height);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const double x = u - 100.3, y = v - 75.2;
      const bool is_near = kind == 0   ? x < 0
                           : kind == 1 ? y < 0
                           : kind == 2 ? x + y < 0
                                       : x * x + y * y < 900;
      depth(v, u) = is_near ? near : far;
    }
  }
  return depth;
}

TEST(FillHoles, NothingIsFilledAcrossAnEdge) {
  for (const auto& [near, far] : {std::pair{1.0F, 1.03F}, {2.0F, 2.1F}, {0.7F, 4.0F}}) {
    for (const int kind : {0, 1, 2, 3}) {
      for (const HolePattern& pattern : HolePatterns()) {
        SCOPED_TRACE(pattern.name + ", kind " + std::to_string(kind));
        const Image<float> filled = Filled(WithHoles(Step(near, far, kind), pattern));
        for (const float z : filled.pixels()) {
          if (std::isnan(z)) continue;
          ASSERT_TRUE(std::abs(z - near) < 1e-4F || std::abs(z - far) < 1e-4F) << z;
        }
      }
    }
  }
}

TEST(FillHoles, NothingIsFilledBetweenABallAndTheWallBehindIt) {
  const TestScene ball{{{Eigen::Vector3d::UnitZ(), 1.3}}, {{Eigen::Vector3d(0, 0, 1.1), 0.1}}};
  const Image<float> exact = Render(ball, kSmall).depth;
  for (const HolePattern& pattern : HolePatterns()) {
    SCOPED_TRACE(pattern.name);
    const Image<float> filled = Filled(WithHoles(exact, pattern), HolesOf(CleanNoise()));
    for (int v = 0; v < kSmall.height; ++v) {
      for (int u = 0; u < kSmall.width; ++u) {
        // The ball ends at a depth of 1.09 m; its border is curved within the noise.
        if (std::isnan(filled(v, u)) || filled(v, u) < 1.12F) continue;
        ASSERT_NEAR(filled(v, u), 1.3F, 0.01F) << v << " " << u;
      }
    }
  }
}

TEST(FillHoles, MeasuredDepthStaysBitForBit) {
  RandomNumbers random(3);
  const PinholeCamera camera = testing_support::RandomCamera(161, 119, &random);
  for (const HolePattern& pattern : HolePatterns()) {
    const Image<float> depth = WithHoles(testing_support::RandomDepth(camera, &random), pattern);
    const Image<float> filled = Filled(depth);
    for (size_t i = 0; i < depth.size(); ++i) {
      const float z = depth.data()[i];
      if (!(z > 0)) continue;
      ASSERT_EQ(filled.data()[i], z);
    }
  }
}

TEST(FillHoles, HolesWiderThanTheLimitStay) {
  const Image<float> wall(64, 48, 1.5F);
  for (const int max_px : {0, 1, 2, 3, 4}) {
    for (int side = 1; side <= 7; ++side) {
      Image<float> depth = wall;
      for (int v = 20; v < 20 + side; ++v) {
        for (int u = 30; u < 30 + side; ++u) depth(v, u) = kNoDepth;
      }
      EXPECT_EQ(CountHoles(Filled(depth, HolesOf(KinectNoise(), max_px))),
                side <= max_px ? 0 : side * side)
          << max_px << " " << side;
    }
  }
}

TEST(FillHoles, AWideHoleIsFilledWhereItIsNarrowTheOtherWay) {
  Image<float> depth(64, 48, 1.5F);
  for (int v = 20; v < 23; ++v) std::fill_n(depth.row(v), 64, kNoDepth);
  EXPECT_EQ(CountHoles(Filled(depth)), 0);
}

TEST(FillHoles, HolesAtTheBorderOfTheImageStay) {
  Image<float> depth(64, 48, 1.5F);
  for (int v = 0; v < 48; ++v) depth(v, 0) = depth(v, 63) = kNoDepth;
  EXPECT_EQ(CountHoles(Filled(depth)), 2 * 48);
}

TEST(FillHoles, TheShorterWayIsTaken) {
  Image<float> depth(64, 48, 1.5F);
  for (int u = 0; u < 64; ++u) depth(23, u) = depth(25, u) = 1.503F;
  for (int u = 30; u < 33; ++u) depth(24, u) = kNoDepth;  // 3 wide, 1 high
  const Image<float> filled = Filled(depth);
  for (int u = 30; u < 33; ++u) EXPECT_NEAR(filled(24, u), 1.503F, 1e-5F);
}

}  // namespace
}  // namespace vismap
