#include "objects/oriented_box.h"

#include <gtest/gtest.h>

#include <numbers>

namespace vismap {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Points on the faces of a turned box, evenly spread.
std::vector<Vector3f> BoxSurface(const Vector3d& center, const Vector3d& size, double yaw,
                                 const Vector3d& up = Vector3d::UnitZ()) {
  const auto [u, v] = HorizontalAxes(up);
  Eigen::Matrix3d axes;
  axes << u, v, up;
  axes = axes * Eigen::AngleAxisd(yaw, Vector3d::UnitZ()).toRotationMatrix();
  std::vector<Vector3f> points;
  constexpr int kSteps = 30;
  for (int face = 0; face < 6; ++face) {
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps; ++j) {
        Vector3d p;
        p[face / 2] = face % 2 - 0.5;
        p[(face / 2 + 1) % 3] = static_cast<double>(i) / kSteps - 0.5;
        p[(face / 2 + 2) % 3] = static_cast<double>(j) / kSteps - 0.5;
        points.push_back((center + axes * p.cwiseProduct(size)).cast<float>());
      }
    }
  }
  return points;
}

TEST(FitUprightBox, FindsEveryYaw) {
  const Vector3d center(3, -2, 1), size(0.8, 0.5, 0.3);
  for (int degrees = -88; degrees < 90; degrees += 8) {
    const double yaw = degrees * std::numbers::pi / 180;
    const OrientedBox box = FitUprightBox(BoxSurface(center, size, yaw), Vector3d::UnitZ(), 0.01);
    EXPECT_LT((box.center_W - center).norm(), 0.005) << degrees;
    EXPECT_LT((box.size - size).norm(), 0.01) << degrees;
    const Vector3d along = box.R_W_B * Vector3d::UnitX();
    EXPECT_GT(std::abs(along.dot(Vector3d(std::cos(yaw), std::sin(yaw), 0))), 0.9999) << degrees;
  }
}

TEST(FitUprightBox, StandsOnAnyUpAxis) {
  const Vector3d up = Vector3d(0.3, -0.9, 0.2).normalized();
  const OrientedBox box = FitUprightBox(BoxSurface({0, 0, 0}, {0.8, 0.5, 0.3}, 0.4, up), up, 0.01);
  EXPECT_LT((box.size - Vector3d(0.8, 0.5, 0.3)).norm(), 0.01);
  EXPECT_GT((box.R_W_B * Vector3d::UnitZ()).dot(up), 1 - 1e-9);
}

TEST(FitUprightBox, FewOutliersDoNotMatter) {
  std::vector<Vector3f> points = BoxSurface({0, 0, 0}, {0.8, 0.5, 0.3}, 0.4);
  for (int i = 0; i < 20; ++i) points.emplace_back(2, 0.1F * static_cast<float>(i), 3);
  EXPECT_LT((FitUprightBox(points, Vector3d::UnitZ(), 0.01).size - Vector3d(0.8, 0.5, 0.3)).norm(),
            0.02);
}

TEST(FitUprightBox, FewPointsAreNoTrouble) {
  EXPECT_EQ(FitUprightBox({}, Vector3d::UnitZ(), 0.01).size, Vector3d::Zero());
  const std::vector<Vector3f> one{{1, 2, 3}};
  EXPECT_EQ(FitUprightBox(one, Vector3d::UnitZ(), 0.01).center_W, Vector3d(1, 2, 3));
  EXPECT_EQ(FitUprightBox(one, Vector3d::UnitZ(), 5).size, Vector3d::Zero());
  const std::vector<Vector3f> two{{0, 0, 0}, {3, 4, 1}};
  EXPECT_NEAR(FitUprightBox(two, Vector3d::UnitZ(), 0).size.x(), 5, 0.01);
}

TEST(MainParts, KeepsWhatIsLargeOrNear) {
  std::vector<Vector3f> points;
  const auto line = [&](float x, int count) {
    for (int i = 0; i < count; ++i) points.emplace_back(x, 0.01F * static_cast<float>(i), 0);
  };
  line(0, 100);    // the object
  line(0.06F, 5);  // near it
  line(1, 30);     // far, but much
  line(2, 5);      // far and little
  const auto kept = MainParts(points, 0.05, 0.1);
  EXPECT_EQ(kept.size(), 135u);
  EXPECT_TRUE(MainParts({}, 0.05, 0.1).empty());
  EXPECT_EQ(MainParts(points, 0, 0.1).size(), points.size());
}

TEST(MainParts, NeverDropsEverything) {
  std::vector<Vector3f> points;
  for (int i = 0; i < 50; ++i) points.emplace_back(static_cast<float>(i), 0, 0);
  EXPECT_EQ(MainParts(points, 0.05, 0.5).size(), 50u);
}

TEST(FitPlane, FindsThePlaneAmongClutter) {
  const Vector3d normal = Vector3d(0.2, -0.3, 0.9).normalized();
  const auto [u, v] = HorizontalAxes(normal);
  std::vector<Vector3f> points;
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      points.push_back((0.4 * normal + u * i * 0.1 + v * j * 0.1).cast<float>());
    }
  }
  for (int i = 0; i < 40; ++i) {
    points.push_back((normal * (0.5 + 0.005 * i) + u * 1 + v * 0.02 * i).cast<float>());
  }
  const PlaneFit fit = FitPlane(points, 0.02);
  EXPECT_GT(std::abs(fit.normal_W.dot(normal)), 0.9999);
  EXPECT_NEAR(fit.inliers, 400.0 / 440, 1e-9);
}

TEST(HorizontalAxes, AreRightHandedForEveryUp) {
  for (const Vector3d& up : {Vector3d(0, 0, 1), Vector3d(1, 0, 0), Vector3d(0, -1, 0),
                             Vector3d(-0.6, 0, 0.8), Vector3d(0, 0, -1)}) {
    const auto [u, v] = HorizontalAxes(up);
    EXPECT_LT((u.cross(v) - up).norm(), 1e-12);
    EXPECT_NEAR(u.norm(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace vismap
