#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "simulation/camera_path.h"
#include "simulation/office.h"
#include "simulation/render_views.h"
#include "simulation/room.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

using Eigen::Vector3d;

const PinholeCamera kOddSize{90, 70, 75, 76, 44.3, 34.6};  // whole tiles and parts of tiles

Vector3d RandomPoint(const Eigen::AlignedBox3d& box, Dice* dice) {
  Vector3d p;
  for (int i = 0; i < 3; ++i) p[i] = dice->Between(box.min()[i], box.max()[i]);
  return p;
}

Pose RandomPose(const Eigen::AlignedBox3d& box, Dice* dice) {
  const Vector3d axis = RandomPoint({Vector3d::Constant(-1), Vector3d::Constant(1)}, dice);
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(dice->Between(0, 3.1), axis.normalized()).toRotationMatrix();
  pose.translation() = RandomPoint(box, dice);
  return pose;
}

/// Solids of all kinds that intersect each other, some of them twice.
Scene Heap(int count, Dice* dice) {
  Scene scene{"heap", {}};
  const Eigen::AlignedBox3d space(Vector3d::Constant(-3), Vector3d::Constant(3));
  for (int i = 0; i < count; ++i) {
    Shape shape{static_cast<Shape::Kind>(dice->Of(3)), RandomPose(space, dice),
                RandomPoint({Vector3d::Constant(0.02), Vector3d::Constant(0.7)}, dice)};
    if (shape.kind == Shape::Kind::kCylinder) shape.half_size.y() = shape.half_size.x();
    for (size_t twice = dice->Of(2) + 1; twice > 0; --twice) {
      const auto id = static_cast<uint16_t>(scene.objects.size() + 1);
      scene.objects.push_back(
          {id, "solid", ClassId::kUnknown, ObjectKind::kUnknown, {90, 160, 220}, {shape}});
    }
  }
  return scene;
}

/// Casts every ray against every shape, in the order of the scene.
void ExpectSameAsEveryShape(const Scene& scene, const Pose& T_W_C) {
  Image<double> depth(kOddSize.width, kOddSize.height, kNoHit);
  Image<uint16_t> ids(kOddSize.width, kOddSize.height);
  for (const SceneObject& object : scene.objects) {
    for (const Shape& shape : object.shapes) {
      const Pose T_O_C = shape.T_W_O.inverse() * T_W_C;
      for (int v = 0; v < kOddSize.height; ++v) {
        for (int u = 0; u < kOddSize.width; ++u) {
          const Vector3d direction_O = T_O_C.linear() * kOddSize.BackProject(u, v, 1);
          const double t = EnterSolid(shape, T_O_C.translation(), direction_O);
          if (t >= depth(v, u)) continue;
          depth(v, u) = t;
          ids(v, u) = object.id;
        }
      }
    }
  }
  const Rendering image = Render(scene, kOddSize, T_W_C);
  EXPECT_EQ(image.object_ids, ids);
  EXPECT_EQ(RenderInstances(scene, kOddSize, T_W_C), ids);
  for (size_t i = 0; i < ids.size(); ++i) {
    if (ids.data()[i] == 0) {
      EXPECT_TRUE(std::isnan(image.depth.data()[i]));
    } else {
      EXPECT_EQ(image.depth.data()[i], static_cast<float>(depth.data()[i]));
    }
  }
}

TEST(Render, EqualsEveryRayAgainstEveryShapeInTheRoom) {
  Dice dice(1);
  const Scene room = MakeRoom();
  for (const Pose& T_W_C : MakeRoomTour(12)) ExpectSameAsEveryShape(room, T_W_C);
  const Eigen::AlignedBox3d space(Vector3d(-3, -2.5, -0.5), Vector3d(3, 2.5, 3));
  for (int i = 0; i < 40; ++i) ExpectSameAsEveryShape(room, RandomPose(space, &dice));
}

TEST(Render, EqualsEveryRayAgainstEveryShapeInTheOffice) {
  Dice dice(2);
  const Scene office = MakeOffice();
  for (const Pose& T_W_C : MakeOfficeWalk(5)) ExpectSameAsEveryShape(office, T_W_C);
  const Eigen::AlignedBox3d space(Vector3d(-19, -12, 0.2), Vector3d(19, 12, 2.4));
  for (int i = 0; i < 5; ++i) ExpectSameAsEveryShape(office, RandomPose(space, &dice));
}

TEST(Render, EqualsEveryRayAgainstEveryShapeInAHeap) {
  Dice dice(3);
  const Eigen::AlignedBox3d space(Vector3d::Constant(-5), Vector3d::Constant(5));
  for (int i = 0; i < 60; ++i) {
    ExpectSameAsEveryShape(Heap(40, &dice), RandomPose(space, &dice));
  }
}

// Inlays are level with a floor. The bound of the floor is nearer, but their pixels must show them.
TEST(Render, OfEqualDepthsTheFirstInTheSceneCounts) {
  const auto slab = [](double x, double y, double half) {
    Shape shape{Shape::Kind::kBox, Pose::Identity(), {half, half, 0.5}};
    shape.T_W_O.translation() = Vector3d(x, y, -0.5);
    return shape;
  };
  SceneObject inlays{1, "inlays", ClassId::kUnknown, ObjectKind::kUnknown, {200, 0, 0}, {}};
  for (int i = -8; i < 8; ++i) {
    for (int k = 0; k < 16; ++k) inlays.shapes.push_back(slab(0.5 * i, 0.5 * k, 0.125));
  }
  const SceneObject floor{
      2, "floor", ClassId::kUnknown, ObjectKind::kStructure, {100, 100, 100}, {slab(0, 4, 16)}};
  const Pose T_W_C = LookAt({0.1, -1, 1.5}, {0.3, 2, 0});
  ExpectSameAsEveryShape({"inlays first", {inlays, floor}}, T_W_C);
  ExpectSameAsEveryShape({"floor first", {floor, inlays}}, T_W_C);
  const Image<uint16_t> ids = RenderInstances({"", {inlays, floor}}, kOddSize, T_W_C);
  EXPECT_GT(std::count(ids.pixels().begin(), ids.pixels().end(), 1), 500);
}

TEST(NearestDepth, IsALowerBoundAndOftenExact) {
  Dice dice(4);
  int close = 0, found = 0;
  for (int i = 0; i < 40; ++i) {
    const Scene heap = Heap(20, &dice);
    const Pose T_W_C = RandomPose({Vector3d::Constant(-5), Vector3d::Constant(5)}, &dice);
    for (const ShapeView& view : MakeShapeViews(heap, kOddSize, T_W_C)) {
      const double bound = NearestDepth(view, kOddSize, view.pixels);
      double nearest = kNoHit;
      for (int v = view.pixels.v0; v < view.pixels.v1; ++v) {
        for (int u = view.pixels.u0; u < view.pixels.u1; ++u) {
          const Vector3d direction_O = view.R_O_C * kOddSize.BackProject(u, v, 1);
          nearest = std::min(nearest, EnterSolid(*view.shape, view.origin_O, direction_O));
        }
      }
      ASSERT_LE(bound, nearest);
      if (nearest == kNoHit) continue;
      ++found;
      if (bound > 0.8 * nearest) ++close;
    }
  }
  EXPECT_GT(found, 100);
  EXPECT_GT(2 * close, found);
}

}  // namespace
}  // namespace vismap
