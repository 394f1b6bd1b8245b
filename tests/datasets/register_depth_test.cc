#include "datasets/register_depth.h"

#include <gtest/gtest.h>

namespace vismap {
namespace {

constexpr double kUnit = 0.001;
constexpr PinholeCamera kDepthCamera{160, 120, 146, 146, 80, 60};
constexpr PinholeCamera kColorCamera{160, 120, 131, 131, 80, 60};

/// A depth camera that is 25 mm to the left of the colour camera and turned a little towards it.
DepthSource Beside() {
  DepthSource from{kDepthCamera, Pose::Identity()};
  from.T_C_D.translation() = Eigen::Vector3d(-0.025, 0.002, 0.003);
  from.T_C_D.linear() =
      Eigen::AngleAxisd(0.02, Eigen::Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  return from;
}

/// The depth [m] of the plane n * p = d of C at a pixel of a camera with the pose T_C_X.
double DepthOfPlane(const Eigen::Vector3d& n_C, double d, const PinholeCamera& camera,
                    const Pose& T_C_X, int u, int v) {
  const Eigen::Vector3d ray_C =
      T_C_X.linear() * Eigen::Vector3d((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1);
  return (d - n_C.dot(T_C_X.translation())) / n_C.dot(ray_C);
}

Image<uint16_t> Render(const Eigen::Vector3d& n_C, double d, const PinholeCamera& camera,
                       const Pose& T_C_X) {
  Image<uint16_t> depth(camera.width, camera.height, uint16_t{0});
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u)
      depth(v, u) =
          static_cast<uint16_t>(std::lround(DepthOfPlane(n_C, d, camera, T_C_X, u, v) / kUnit));
  }
  return depth;
}

TEST(RegisterDepth, ASlantedPlaneIsWhereTheColourCameraSeesIt) {
  const Eigen::Vector3d n_C = Eigen::Vector3d(0.3, -0.2, 1).normalized();
  const DepthSource from = Beside();
  const Image<uint16_t> seen =
      RegisterDepth(Render(n_C, 1.5, kDepthCamera, from.T_C_D), kUnit, from, kColorCamera);
  const Image<uint16_t> truth = Render(n_C, 1.5, kColorCamera, Pose::Identity());
  int filled = 0;
  for (int v = 0; v < seen.height(); ++v) {
    for (int u = 0; u < seen.width(); ++u) {
      if (seen(v, u) == 0) continue;
      ++filled;
      // Half a pixel off, at 3 mm per pixel; and a millimetre is a step.
      EXPECT_NEAR(seen(v, u), truth(v, u), 5) << u << ", " << v;
    }
  }
  // The colour camera sees 1.1 times as far to every side: of what both see nothing is missing.
  EXPECT_GT(filled, 0.8 * 160 * 120 * (131.0 / 146) * (131.0 / 146));
}

TEST(RegisterDepth, SameCameraChangesNothing) {
  const Image<uint16_t> depth = Render({0.1, 0, 1}, 1, kDepthCamera, Pose::Identity());
  EXPECT_EQ(RegisterDepth(depth, kUnit, {kDepthCamera, Pose::Identity()}, kDepthCamera), depth);
}

/// All returns of an image, in row order.
std::vector<uint16_t> Returns(const Image<uint16_t>& depth) {
  std::vector<uint16_t> returns;
  for (const uint16_t steps : depth.pixels()) {
    if (steps != 0) returns.push_back(steps);
  }
  return returns;
}

TEST(RegisterDepth, TheNearerReturnHidesTheFartherOneInEitherOrder) {
  // The cameras are 0.1 m apart. The disparity of a point is 14.6 pixels at 1 m and 7.3 pixels at 2
  // m.
  struct Case {
    double beside;      // [m]
    int u_near, u_far;  // both are projected to column 55
  };
  for (const auto& [beside, u_near, u_far] : {Case{0.1, 40, 48}, Case{-0.1, 70, 62}}) {
    DepthSource from{kDepthCamera, Pose::Identity()};
    from.T_C_D.translation().x() = beside;
    Image<uint16_t> depth(160, 120, uint16_t{0});
    depth(60, u_near) = 1000;
    depth(60, u_far) = 2000;
    EXPECT_EQ(Returns(RegisterDepth(depth, kUnit, from, kDepthCamera)),
              std::vector<uint16_t>{1000});
    depth(60, u_near) = 0;
    EXPECT_EQ(Returns(RegisterDepth(depth, kUnit, from, kDepthCamera)),
              std::vector<uint16_t>{2000});
  }
}

TEST(RegisterDepth, WhatIsNoReturnOrCannotBeSeenIsNone) {
  const auto seen_from = [](const Eigen::Vector3d& p_C_D, uint16_t steps) {
    DepthSource from{kDepthCamera, Pose::Identity()};
    from.T_C_D.translation() = p_C_D;
    Image<uint16_t> depth(160, 120, uint16_t{0});
    depth(60, 80) = steps;
    return Returns(RegisterDepth(depth, kUnit, from, kDepthCamera));
  };
  EXPECT_EQ(seen_from({0, 0, 0.5}, 1000), std::vector<uint16_t>{1500});
  EXPECT_TRUE(seen_from({0, 0, 0}, 65535).empty()) << "no return";
  EXPECT_TRUE(seen_from({0, 0, 0.6}, 65000).empty()) << "too far for 16 bits";
  EXPECT_TRUE(seen_from({0, 0, -2}, 1000).empty()) << "behind the colour camera";
  EXPECT_TRUE(seen_from({5, 0, 0}, 1000).empty()) << "outside the image";
}

TEST(RegisterDepth, AnImageOfAnotherSizeThrows) {
  EXPECT_THROW(RegisterDepth(Image<uint16_t>(3, 3), kUnit, Beside(), kColorCamera),
               std::logic_error);
}

}  // namespace
}  // namespace vismap
