#include "geometry/compute_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"
#include "support/analytic_depth.h"

namespace vismap {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

SurfaceOptions With(const DepthNoiseModel& noise) {
  SurfaceOptions options;
  options.noise = noise;
  return options;
}

double AngleDeg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Whether two images are equal; NaN equals NaN.
bool Same(const Image<float>& a, const Image<float>& b) {
  return a.size() == b.size() &&
         std::equal(a.pixels().begin(), a.pixels().end(), b.pixels().begin(),
                    [](float x, float y) { return x == y || (x != x && y != y); });
}

/// Median over the image of the angle between estimated and given normal [deg].
double MedianError(const SurfaceMap& surface, const Eigen::Vector3d& truth) {
  std::vector<double> errors;
  for (int v = 0; v < surface.joined.height(); ++v) {
    for (int u = 0; u < surface.joined.width(); ++u) {
      if (!surface.normals_C.valid(v, u)) continue;
      errors.push_back(AngleDeg(surface.normals_C.at(v, u).cast<double>(), truth));
    }
  }
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return *middle;
}

TEST(ComputeSurface, BackProjectsEveryPixelWithDepth) {
  const TestView view = Render({{{Eigen::Vector3d(0.3, 0.2, 1).normalized(), 2.0}}, {}});
  const SurfaceMap surface = ComputeSurface(view.depth, kVga, With(CleanNoise()));
  for (const auto& [v, u] : {std::pair{0, 0}, {239, 320}, {479, 639}}) {
    const Eigen::Vector3d expected = kVga.BackProject(u, v, view.depth(v, u));
    EXPECT_LT((surface.points_C.at(v, u).cast<double>() - expected).norm(), 1e-5);
  }
}

TEST(ComputeSurface, SlantedPlaneHasItsNormalEverywhereToTheImageBorder) {
  for (const double slope : {0.0, 0.5, 1.5}) {
    const Eigen::Vector3d normal = Eigen::Vector3d(slope, -0.5 * slope, 1).normalized();
    const TestView view = Render({{{normal, 1.5}}, {}});
    const SurfaceMap surface = ComputeSurface(view.depth, kVga, With(CleanNoise()));
    for (int v = 0; v < kVga.height; ++v) {
      for (int u = 0; u < kVga.width; ++u) {
        if (!surface.points_C.valid(v, u)) continue;
        ASSERT_TRUE(surface.normals_C.valid(v, u)) << v << " " << u;
        ASSERT_LT(AngleDeg(surface.normals_C.at(v, u).cast<double>(), -normal), 0.3)
            << v << " " << u << " slope " << slope;
      }
    }
  }
}

TEST(ComputeSurface, NormalsAreUnitAndFaceTheCamera) {
  const TestView view = Render(
      {{{Eigen::Vector3d(0, -1, 0.2).normalized(), -0.4}}, {{Eigen::Vector3d(0.1, 0, 1.5), 0.3}}});
  const SurfaceMap surface =
      ComputeSurface(AddNoise(view.depth, KinectNoise(), 3, 1), kVga, SurfaceOptions{});
  for (int v = 0; v < kVga.height; ++v) {
    for (int u = 0; u < kVga.width; ++u) {
      if (!surface.normals_C.valid(v, u)) continue;
      const Eigen::Vector3f normal = surface.normals_C.at(v, u);
      ASSERT_NEAR(normal.norm(), 1, 1e-4);
      ASSERT_LE(normal.dot(surface.points_C.at(v, u)), 0);
      ASSERT_GE(surface.normal_sigma(v, u), 0);
    }
  }
}

TEST(ComputeSurface, WindowsDoNotReachAcrossADepthJump) {
  // A board at 1 m before a wall at 2 m, and both level: any mixing would tilt the normals.
  const TestScene scene{{{Eigen::Vector3d(0, 0, 1), 2.0},
                         {Eigen::Vector3d(0, 0, 1), 1.0,
                          [](const Eigen::Vector3d& p) { return std::abs(p.x()) < 0.2; }}},
                        {}};
  const SurfaceMap surface = ComputeSurface(Render(scene).depth, kVga, SurfaceOptions{});
  for (int v = 0; v < kVga.height; ++v) {
    for (int u = 0; u < kVga.width; ++u) {
      ASSERT_TRUE(surface.normals_C.valid(v, u));
      ASSERT_NEAR(surface.normals_C.z(v, u), -1, 1e-4) << v << " " << u;
    }
  }
}

TEST(ComputeSurface, WindowGrowsWithRangeSoThatNormalsStayGoodInNoise) {
  int last_radius = 0;
  for (const double z : {0.8, 1.6, 3.0, 4.0}) {
    const TestView view = Render({{{Eigen::Vector3d(0, 0, 1), z}}, {}});
    const SurfaceMap surface =
        ComputeSurface(AddNoise(view.depth, KinectNoise(), 3, 7), kVga, SurfaceOptions{});
    EXPECT_GE(surface.radius(240, 320), last_radius);
    last_radius = surface.radius(240, 320);
    EXPECT_LT(MedianError(surface, {0, 0, -1}), 12) << z;
    // The expected error is about as large as the true one.
    EXPECT_GT(3 * surface.normal_sigma(240, 320) * 180 / std::numbers::pi,
              MedianError(surface, {0, 0, -1}))
        << z;
  }
  EXPECT_GT(last_radius, SurfaceOptions{}.min_radius_px);
}

TEST(ComputeSurface, PixelsWithoutDepthHaveNoPointNoNormalAndAreJoinedToNothing) {
  TestView view = Render({{{Eigen::Vector3d(0, 0, 1), 1.0}}, {}});
  const float holes[] = {kNaN, 0.0F, -1.0F, std::numeric_limits<float>::infinity(), 50.0F, 1e-30F};
  int u = 100;
  for (const float hole : holes) view.depth(200, u += 20) = hole;
  const SurfaceMap surface = ComputeSurface(view.depth, kVga, SurfaceOptions{});
  for (u = 120; u <= 220; u += 20) {
    EXPECT_FALSE(surface.points_C.valid(200, u));
    EXPECT_FALSE(surface.normals_C.valid(200, u));
    EXPECT_EQ(surface.radius(200, u), 0);
    EXPECT_EQ(surface.joined(200, u), 0);
    EXPECT_EQ(surface.joined(200, u - 1) & kJoinedRight, 0);
    EXPECT_EQ(surface.joined(199, u) & kJoinedDown, 0);
    EXPECT_NEAR(surface.normals_C.z(200, u + 1), -1, 1e-3);  // normals beside a hole are good
  }
}

TEST(ComputeSurface, ASingleRowOfPixelsHasNoNormal) {
  Image<float> depth(kVga.width, kVga.height, kNaN);
  for (int u = 0; u < kVga.width; ++u) depth(100, u) = 1.0F;
  const SurfaceMap surface = ComputeSurface(depth, kVga, SurfaceOptions{});
  EXPECT_TRUE(surface.points_C.valid(100, 300));
  EXPECT_FALSE(surface.normals_C.valid(100, 300));
}

TEST(ComputeSurface, AgreesWithTheCovarianceOfAllPointsNearby) {
  const TestScene scene{{{Eigen::Vector3d(0.4, -0.3, 1).normalized(), 1.2}},
                        {{Eigen::Vector3d(0.2, 0.1, 0.9), 0.25}}};
  SurfaceOptions slow = With(CleanNoise());
  slow.min_radius_px = slow.max_radius_px = 6;  // 13 px, as the published window
  slow.method = NormalMethod::kWindowCovariance;
  SurfaceOptions fast = slow;
  fast.method = NormalMethod::kInverseDepthFit;
  const TestView view = Render(scene);
  const SurfaceMap a = ComputeSurface(view.depth, kVga, fast);
  const SurfaceMap b = ComputeSurface(view.depth, kVga, slow);
  int compared = 0, apart = 0;
  for (int v = 0; v < kVga.height; ++v) {
    for (int u = 0; u < kVga.width; ++u) {
      if (!a.normals_C.valid(v, u) || !b.normals_C.valid(v, u)) continue;
      ++compared;
      apart +=
          AngleDeg(a.normals_C.at(v, u).cast<double>(), b.normals_C.at(v, u).cast<double>()) > 5;
    }
  }
  EXPECT_GT(compared, 300000);
  EXPECT_LT(apart, compared / 50);  // only around the sphere's outline
}

TEST(ComputeSurface, SameBitsForAnyNumberOfThreads) {
  const TestView view = Render({{{Eigen::Vector3d(0.4, -0.3, 1).normalized(), 2.2}},
                                {{Eigen::Vector3d(0.2, 0.1, 1.5), 0.25}}});
  const Image<float> depth = AddNoise(view.depth, KinectNoise(), 3, 3);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return ComputeSurface(depth, kVga, SurfaceOptions{});
  };
  const SurfaceMap one = run(1), four = run(4);
  EXPECT_TRUE(Same(one.normals_C.x, four.normals_C.x));
  EXPECT_TRUE(Same(one.normals_C.y, four.normals_C.y));
  EXPECT_TRUE(Same(one.normals_C.z, four.normals_C.z));
  EXPECT_TRUE(Same(one.normal_sigma, four.normal_sigma));
  EXPECT_EQ(one.joined, four.joined);
}

TEST(ComputeSurface, AcceptsTinyImagesAndThrowsForImagesOfAnotherSize) {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {1, 3}, {3, 2}}) {
    const PinholeCamera camera{width, height, 500, 500, 0.5, 0.5};
    const SurfaceMap surface =
        ComputeSurface(Image<float>(width, height, 1.0F), camera, SurfaceOptions{});
    EXPECT_EQ(surface.normals_C.z.size(), surface.joined.size());
  }
  EXPECT_THROW(ComputeSurface(Image<float>(3, 2, 1.0F), kVga, SurfaceOptions{}), std::logic_error);
}

TEST(DepthNoiseModel, PresetsAreValidAndGrowWithRange) {
  for (const DepthNoiseModel& model : {KinectNoise(), RealSenseNoise(), CleanNoise()}) {
    EXPECT_TRUE(Validate(model).empty());
    EXPECT_GE(model.AxialSigma(4), model.AxialSigma(1));
  }
  EXPECT_NEAR(KinectNoise().AxialSigma(2.4), 0.0012 + 0.0019 * 4, 1e-9);
  EXPECT_NEAR(KinectNoise().disparity_step_per_m * 25, 0.07, 0.005);  // Khoshelham: 7 cm at 5 m
}

TEST(SurfaceOptions, ValidateNamesEveryProblem) {
  EXPECT_TRUE(Validate(SurfaceOptions{}).empty());
  SurfaceOptions bad;
  bad.max_depth_m = std::numeric_limits<double>::quiet_NaN();
  bad.min_radius_px = 20;
  bad.window_px = 4;
  bad.noise.axial_base_m = -1;
  const auto problems = Validate(bad);
  ASSERT_EQ(problems.size(), 4u);
  EXPECT_NE(problems[0].find("max_depth"), std::string::npos);
  EXPECT_NE(problems[3].find("noise_axial_base_m"), std::string::npos);
}

}  // namespace
}  // namespace vismap
