#include "simulation/shape.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/mutations.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

Vector3d InCube(TestRandom* random, double half) {
  return Vector3d(random->Unit() - 0.5, random->Unit() - 0.5, random->Unit() - 0.5) * 2 * half;
}

Vector3d Direction(TestRandom* random) {
  Vector3d d = InCube(random, 1);
  while (d.norm() < 0.1 || d.norm() > 1) d = InCube(random, 1);
  return d.normalized();
}

std::vector<Shape> SomeShapes() {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(0.8, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  pose.translation() = Vector3d(0.3, -0.2, 0.1);
  return {{Shape::Kind::kBox, pose, {0.5, 0.3, 0.8}},
          {Shape::Kind::kEllipsoid, pose, {0.7, 0.7, 0.7}},
          {Shape::Kind::kEllipsoid, pose, {0.9, 0.2, 0.5}},
          {Shape::Kind::kEllipsoid, Pose::Identity(), {0.1, 0.6, 0.6}},
          {Shape::Kind::kCylinder, pose, {0.4, 0.4, 0.9}},
          {Shape::Kind::kCylinder, pose, {0.8, 0.8, 0.05}}};
}

double EnterFromWorld(const Shape& shape, const Vector3d& origin_W, const Vector3d& direction_W) {
  const Pose T_O_W = shape.T_W_O.inverse();
  return EnterSolid(shape, T_O_W * origin_W, T_O_W.linear() * direction_W);
}

/// Finds the first hit of a ray by sphere tracing, which uses only distances to the surface and no
/// formulas of intersections.
double March(const Shape& shape, const Vector3d& origin_W, const Vector3d& direction_W) {
  double t = 0;
  for (int i = 0; i < 3000 && t < 20; ++i) {
    const double distance = SignedDistance(shape, origin_W + t * direction_W);
    if (distance < 1e-9) return t;
    t += distance;
  }
  return kNoHit;
}

TEST(Shape, RaysAndDistancesAgree) {
  TestRandom random(1);
  int hits = 0;
  for (const Shape& shape : SomeShapes()) {
    for (int i = 0; i < 150; ++i) {
      const Vector3d origin = Direction(&random) * 3;
      const Vector3d direction = (InCube(&random, 0.9) - origin).normalized();
      const double t = EnterFromWorld(shape, origin, direction);
      const double marched = March(shape, origin, direction);
      if (t == kNoHit && marched == kNoHit) continue;
      if (t == kNoHit || marched == kNoHit) {
        // A grazing ray may hit or miss.
        double nearest = kNoHit;
        for (double s = 0; s < 6; s += 0.001) {
          nearest = std::min(nearest, SignedDistance(shape, origin + s * direction));
        }
        EXPECT_NEAR(nearest, 0, 1e-3);
        continue;
      }
      ++hits;
      EXPECT_NEAR(SignedDistance(shape, origin + t * direction), 0, 1e-9);
      EXPECT_NEAR(t, marched, 1e-4);
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(Shape, ARayFromInsideOrPointingAwayDoesNotEnter) {
  for (const Shape& shape : SomeShapes()) {
    EXPECT_EQ(EnterSolid(shape, Vector3d(0.01, 0.02, 0.01), Vector3d(0.3, 0.4, 0.5)), kNoHit);
    EXPECT_EQ(EnterSolid(shape, Vector3d(3, 0, 0), Vector3d(1, 0, 0)), kNoHit);
    EXPECT_EQ(EnterSolid(shape, Vector3d(3, 3, 0), Vector3d(0, 0, 1)), kNoHit);
    EXPECT_NE(EnterSolid(shape, Vector3d(0, 0, 3), Vector3d(0, 0, -1)), kNoHit);
    EXPECT_NE(EnterSolid(shape, Vector3d(0, 3, 0), Vector3d(0, -1, 0)), kNoHit);
  }
}

TEST(Shape, ScalingTheDirectionScalesTheParameter) {
  for (const Shape& shape : SomeShapes()) {
    const Vector3d origin(0.05, 0.04, 4), direction(0, 0.01, -1);
    EXPECT_NEAR(EnterSolid(shape, origin, direction), 2 * EnterSolid(shape, origin, 2 * direction),
                1e-12);
  }
}

TEST(Shape, TheNormalIsTheGradientOfTheDistance) {
  TestRandom random(2);
  for (const Shape& shape : SomeShapes()) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d origin = Direction(&random) * 3;
      const Vector3d direction = (InCube(&random, 0.3) - origin).normalized();
      const double t = EnterFromWorld(shape, origin, direction);
      if (t == kNoHit) continue;
      const Vector3d p_W = origin + t * direction;
      const Vector3d normal =
          shape.T_W_O.linear() * OutwardNormal(shape, shape.T_W_O.inverse() * p_W);
      EXPECT_NEAR(normal.norm(), 1, 1e-12);
      EXPECT_LT(normal.dot(direction), 0);
      EXPECT_NEAR(SignedDistance(shape, p_W + 1e-4 * normal), 1e-4, 1e-6);
    }
  }
}

TEST(SignedDistance, OfASphereIsExact) {
  const Shape sphere{Shape::Kind::kEllipsoid, Pose::Identity(), {0.7, 0.7, 0.7}};
  TestRandom random(3);
  for (int i = 0; i < 200; ++i) {
    const Vector3d p = InCube(&random, 2);
    EXPECT_NEAR(SignedDistance(sphere, p), p.norm() - 0.7, 1e-9);
  }
  EXPECT_NEAR(SignedDistance(sphere, Vector3d::Zero()), -0.7, 1e-9);
}

TEST(SignedDistance, OfABoxIsExact) {
  const Shape box{Shape::Kind::kBox, Pose::Identity(), {1, 2, 3}};
  EXPECT_DOUBLE_EQ(SignedDistance(box, {3, 0, 0}), 2);
  EXPECT_DOUBLE_EQ(SignedDistance(box, {4, 6, 0}), 5);
  EXPECT_DOUBLE_EQ(SignedDistance(box, {0.25, 0, 0}), -0.75);
  EXPECT_DOUBLE_EQ(SignedDistance(box, {2, 3, 4}), std::sqrt(3.0));
}

TEST(SignedDistance, OfACylinderIsExact) {
  const Shape cylinder{Shape::Kind::kCylinder, Pose::Identity(), {1, 1, 2}};
  EXPECT_DOUBLE_EQ(SignedDistance(cylinder, {3, 4, 0}), 4);
  EXPECT_DOUBLE_EQ(SignedDistance(cylinder, {0, 0, 5}), 3);
  EXPECT_DOUBLE_EQ(SignedDistance(cylinder, {4, 0, 6}), 5);
  EXPECT_DOUBLE_EQ(SignedDistance(cylinder, {0, 0.5, 0}), -0.5);
}

TEST(SignedDistance, OfAnEllipsoidIsThatOfItsNearestPoint) {
  const Vector3d r(0.9, 0.2, 0.5);
  const Shape shape{Shape::Kind::kEllipsoid, Pose::Identity(), r};
  std::vector<Vector3d> surface;
  for (int i = 0; i <= 400; ++i) {
    for (int k = 0; k < 800; ++k) {
      const double a = M_PI * i / 400, b = 2 * M_PI * k / 800;
      surface.emplace_back(r.x() * std::sin(a) * std::cos(b), r.y() * std::sin(a) * std::sin(b),
                           r.z() * std::cos(a));
    }
  }
  TestRandom random(4);
  for (int i = 0; i < 20; ++i) {
    const Vector3d p = InCube(&random, 1.2);
    double nearest = kNoHit;
    for (const Vector3d& q : surface) nearest = std::min(nearest, (p - q).norm());
    const bool inside = p.cwiseQuotient(r).norm() < 1;
    EXPECT_NEAR(SignedDistance(shape, p), inside ? -nearest : nearest, 2e-3);
  }
}

TEST(BoundingBox, HoldsTheShapeAndTouchesIt) {
  for (const Shape& shape : SomeShapes()) {
    const Eigen::AlignedBox3d box = BoundingBox(shape);
    for (int axis = 0; axis < 3; ++axis) {
      // The least distance over a face of the box is 0: the shape touches the face and is inside.
      double nearest = kNoHit;
      for (int i = 0; i <= 100; ++i) {
        for (int k = 0; k <= 100; ++k) {
          Vector3d p = box.min();
          const int a = (axis + 1) % 3, b = (axis + 2) % 3;
          p[a] += box.sizes()[a] * i / 100;
          p[b] += box.sizes()[b] * k / 100;
          nearest = std::min(nearest, SignedDistance(shape, p));
        }
      }
      EXPECT_GT(nearest, -1e-9);
      EXPECT_LT(nearest, 0.01);
    }
  }
}

}  // namespace
}  // namespace vismap
