#include "simulation/room.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "base/class_names.h"
#include "simulation/simulate.h"
#include "support/cast_ray.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using testing_support::CastRay;

const PinholeCamera kSmall{160, 120, 131.25, 131.25, 79.5, 59.5};

TEST(Room, HasStructureKnownAndUnknownObjects) {
  const Scene room = MakeRoom();
  std::map<ObjectKind, int> kinds;
  std::set<uint16_t> ids;
  for (const SceneObject& object : room.objects) {
    ++kinds[object.kind];
    ids.insert(object.id);
    EXPECT_EQ(object.class_id != ClassId::kUnknown, object.kind == ObjectKind::kKnown);
    EXPECT_TRUE(object.kind != ObjectKind::kKnown || ClassName(object.class_id) == object.name);
    EXPECT_EQ(FindObject(room, object.id), &object);
  }
  EXPECT_EQ(kinds[ObjectKind::kStructure], 6);
  EXPECT_EQ(kinds[ObjectKind::kKnown], 12);
  EXPECT_EQ(kinds[ObjectKind::kUnknown], 6);
  EXPECT_EQ(ids.size(), room.objects.size());
  EXPECT_FALSE(ids.contains(0));
  EXPECT_EQ(FindObject(room, 999), nullptr);
}

TEST(Room, ObjectsStandInItAndDoNotShareSpace) {
  const Scene room = MakeRoom();
  const Eigen::AlignedBox3d inside(Vector3d(-2.5, -2, 0), Vector3d(2.5, 2, 2.6));
  for (const SceneObject& object : room.objects) {
    if (object.kind == ObjectKind::kStructure) continue;
    EXPECT_LT(BoundingBox(object).exteriorDistance(inside), 1e-9) << object.name;
    Eigen::AlignedBox3d grown = inside;
    grown.min().array() -= 1e-9;
    EXPECT_TRUE(grown.contains(BoundingBox(object))) << object.name;
  }
  for (const SceneObject& object : room.objects) {
    for (const SceneObject& other : room.objects) {
      if (other.id <= object.id) continue;
      const Eigen::AlignedBox3d both = BoundingBox(object).intersection(BoundingBox(other));
      if (both.isEmpty()) continue;
      constexpr int kSteps = 16;
      for (int k = 0; k < kSteps * kSteps * kSteps; ++k) {
        const Vector3d step(k % kSteps, k / kSteps % kSteps, k / kSteps / kSteps);
        const Vector3d p_W = both.min() + (step / (kSteps - 1)).cwiseProduct(both.sizes());
        const double deep = std::max(SignedDistance(object, p_W), SignedDistance(other, p_W));
        // The pillow sinks into the couch a little.
        ASSERT_GT(deep, -0.012) << object.name << " and " << other.name << " at "
                                << p_W.transpose();
      }
    }
  }
}

TEST(Room, DistancesToItsWallsAreExact) {
  const Scene room = MakeRoom();
  EXPECT_NEAR(SignedDistance(room, {0, 0, 2.5}), 0.1, 1e-12);
  EXPECT_NEAR(SignedDistance(room, {-2.4, 0, 2.0}), 0.1, 1e-12);
  EXPECT_NEAR(SignedDistance(room, {0, -1.9, 2.0}), 0.1, 1e-12);
  EXPECT_LT(SignedDistance(room, {0, 0, -0.05}), 0);
  const auto hit = CastRay(room, {0, 0, 2}, {0, 0, 1});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 0.6, 1e-12);
  EXPECT_EQ(FindObject(room, hit->object_id)->name, "ceiling");
  EXPECT_EQ(hit->normal_W, Vector3d(0, 0, -1));
  EXPECT_NEAR(CastRay(room, {0, 0, 2}, {0, 0, -1})->t, 1.24, 1e-12);  // the table top
}

TEST(Room, CanBeLeftNowhere) {
  const Scene room = MakeRoom();
  for (int i = 0; i < 1000; ++i) {
    const Vector3d d(std::cos(i * 0.7), std::sin(i * 0.7), std::cos(i * 0.317));
    EXPECT_TRUE(CastRay(room, {0, 0, 1.8}, d));
  }
}

TEST(RoomTour, IsSmoothAndFreeOfCollisions) {
  const Scene room = MakeRoom();
  const std::vector<Pose> tour = MakeRoomTour(80);
  ASSERT_EQ(tour.size(), 80u);
  for (size_t i = 0; i < tour.size(); ++i) {
    const Pose& next = tour[(i + 1) % tour.size()];
    EXPECT_TRUE(MakePose(tour[i].matrix()));
    EXPECT_GT(SignedDistance(room, tour[i].translation()), 0.4) << i;
    EXPECT_LT((next.translation() - tour[i].translation()).norm(), 0.4) << i;
    EXPECT_LT(Eigen::AngleAxisd((tour[i].inverse() * next).linear()).angle(), 0.3) << i;
    EXPECT_NEAR(tour[i].linear()(2, 0), 0, 1e-12) << "the horizon is level";
    EXPECT_LT(tour[i].linear()(2, 1), 0) << "image y points down";
  }
}

TEST(RoomTour, ShowsEveryObjectOften) {
  const Scene room = MakeRoom();
  std::map<uint16_t, int> frames;
  for (const Pose& T_W_C : MakeRoomTour(40)) {
    std::map<uint16_t, int> pixels;
    const Image<uint16_t> ids = RenderInstances(room, kSmall, T_W_C);
    for (const uint16_t id : ids.pixels()) ++pixels[id];
    for (const auto& [id, count] : pixels) frames[id] += count >= 20 ? 1 : 0;
  }
  for (const SceneObject& object : room.objects) {
    EXPECT_GE(frames[object.id], object.name == "ceiling" ? 0 : 8) << object.name;
  }
  EXPECT_EQ(frames[0], 0) << "every pixel shows something";
}

TEST(RoomTour, MorePosesAreTheSameTour) {
  const std::vector<Pose> few = MakeRoomTour(20), many = MakeRoomTour(40);
  for (size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i].matrix(), many[2 * i].matrix());
}

}  // namespace
}  // namespace vismap
