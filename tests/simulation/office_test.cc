#include "simulation/office.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>

#include "base/class_names.h"
#include "simulation/office_plan.h"
#include "simulation/simulate.h"
#include "support/cast_ray.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using testing_support::CastRay;

const PinholeCamera kTiny{80, 60, 65.625, 65.625, 39.5, 29.5};
constexpr int kFrames = 400;

TEST(Office, HasHundredsOfKnownAndUnknownObjects) {
  const Scene office = MakeOffice();
  std::map<ObjectKind, int> kinds;
  std::set<uint16_t> ids;
  std::set<std::string> names;
  for (const SceneObject& object : office.objects) {
    ++kinds[object.kind];
    ids.insert(object.id);
    names.insert(object.name);
    EXPECT_EQ(object.class_id != ClassId::kUnknown, object.kind == ObjectKind::kKnown);
    EXPECT_TRUE(object.kind != ObjectKind::kKnown || ClassName(object.class_id) == object.name)
        << object.name;
  }
  EXPECT_GT(kinds[ObjectKind::kKnown], 400);
  EXPECT_GT(kinds[ObjectKind::kUnknown], 200);
  EXPECT_EQ(ids.size(), office.objects.size());
  EXPECT_EQ(*ids.begin(), 1);
  EXPECT_EQ(*ids.rbegin(), office.objects.size()) << "more than a byte holds";
  for (const char* name :
       {"chair",        "tv",    "keyboard",     "cup",          "bottle",     "book",   "backpack",
        "potted plant", "couch", "dining table", "refrigerator", "microwave",  "laptop", "cabinet",
        "box",          "bin",   "lamp",         "printer",      "whiteboard", "pillar"}) {
    EXPECT_TRUE(names.contains(name)) << name;
  }
}

TEST(Office, IsTheSameEveryTime) {
  const Scene first = MakeOffice(), second = MakeOffice();
  ASSERT_EQ(first.objects.size(), second.objects.size());
  for (size_t i = 0; i < first.objects.size(); ++i) {
    const SceneObject &a = first.objects[i], &b = second.objects[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.color, b.color);
    ASSERT_EQ(a.shapes.size(), b.shapes.size());
    for (size_t k = 0; k < a.shapes.size(); ++k) {
      EXPECT_EQ(a.shapes[k].T_W_O.matrix(), b.shapes[k].T_W_O.matrix());
      EXPECT_EQ(a.shapes[k].half_size, b.shapes[k].half_size);
    }
  }
}

TEST(Office, HasAFloorOfAThousandSquareMetresAndCanBeLeftNowhere) {
  const Scene office = MakeOffice();
  const Eigen::AlignedBox3d inside(Vector3d(-20, -12.5, 0), Vector3d(20, 12.5, 2.6));
  EXPECT_EQ(inside.sizes().x() * inside.sizes().y(), 1000);
  for (const SceneObject& object : office.objects) {
    if (object.kind == ObjectKind::kStructure) continue;
    EXPECT_GT((BoundingBox(object).min() - inside.min()).minCoeff(), -1e-9) << object.name;
    EXPECT_GT((inside.max() - BoundingBox(object).max()).minCoeff(), -1e-9) << object.name;
  }
  for (const Vector3d& corner : {Vector3d(-19.9, -12.4, 2.5), Vector3d(19.9, 12.4, 2.5)}) {
    EXPECT_NEAR(SignedDistance(office, corner), 0.1, 1e-9);
  }
  for (int i = 0; i < 200; ++i) {
    const Vector3d d(std::cos(i * 0.7), std::sin(i * 0.7), std::cos(i * 0.317));
    EXPECT_TRUE(CastRay(office, {-14.5, 0, 1.8}, d));
  }
}

/// The largest depth inside of both objects, over a grid in the common part of their boxes [m].
double DeepestCommonPoint(const SceneObject& a, const SceneObject& b) {
  constexpr int kSteps = 7;
  double deepest = 0;
  const Eigen::AlignedBox3d both = BoundingBox(a).intersection(BoundingBox(b));
  for (int k = 0; k < kSteps * kSteps * kSteps; ++k) {
    const Vector3d step(k % kSteps, k / kSteps % kSteps, k / kSteps / kSteps);
    const Vector3d p_W = both.min() + (step / (kSteps - 1)).cwiseProduct(both.sizes());
    deepest = std::max(deepest, -std::max(SignedDistance(a, p_W), SignedDistance(b, p_W)));
  }
  return deepest;
}

TEST(Office, ThingsDoNotShareSpace) {
  const Scene office = MakeOffice();
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const SceneObject& object : office.objects) boxes.push_back(BoundingBox(object));
  for (size_t i = 0; i < boxes.size(); ++i) {
    for (size_t k = i + 1; k < boxes.size(); ++k) {
      if (!boxes[i].intersects(boxes[k])) continue;
      const SceneObject &a = office.objects[i], &b = office.objects[k];
      EXPECT_LT(DeepestCommonPoint(a, b), 0.006)  // a vase's round bottom sinks in a little
          << a.name << " and " << b.name << " at " << boxes[k].center().transpose();
    }
  }
}

TEST(Office, RoomsCanBeEntered) {
  const Scene office = MakeOffice();
  for (const Opening& opening : OfficeOpenings()) {
    EXPECT_GT(SignedDistance(office, {opening.x, opening.y, 1.5}), 0.49);
  }
  for (const OfficeRoom& room : OfficeRooms()) {
    for (double y = 0; y < 1.2; y += 0.2) {
      EXPECT_GT(SignedDistance(office, room.place.At({0, y, 1.0}).origin_W), 0.2);
    }
    EXPECT_GT(room.right - room.left, 4);
    EXPECT_GT(room.depth, 4);
  }
}

TEST(OfficeWalk, IsLongAndInSmallSteps) {
  const std::vector<Pose> walk = MakeOfficeWalk(kFrames);
  ASSERT_EQ(walk.size(), static_cast<size_t>(kFrames));
  double length = 0;
  for (size_t i = 0; i < walk.size(); ++i) {
    const Pose& next = walk[(i + 1) % walk.size()];
    const double step = (next.translation() - walk[i].translation()).norm();
    length += step;
    EXPECT_TRUE(MakePose(walk[i].matrix()));
    EXPECT_LT(step, 0.45) << i;
    EXPECT_LT(Eigen::AngleAxisd((walk[i].inverse() * next).linear()).angle(), 0.3) << i;
    EXPECT_EQ(walk[i].translation().z(), 1.5);
    EXPECT_NEAR(walk[i].linear()(2, 0), 0, 1e-12) << "the horizon is level";
    EXPECT_LT(walk[i].linear()(2, 2), -0.2) << "a little down";
  }
  EXPECT_GT(length, 120);
}

TEST(OfficeWalk, PassesThroughNothing) {
  const Scene office = MakeOffice();
  for (const Pose& T_W_C : MakeOfficeWalk(2 * kFrames)) {
    const Vector3d eye = T_W_C.translation();
    EXPECT_GT(SignedDistance(office, eye), 0.4) << eye.transpose();
    for (const double z : {0.3, 0.6, 0.9, 1.2}) {
      EXPECT_GT(SignedDistance(office, {eye.x(), eye.y(), z}), 0.15) << eye.transpose();
    }
  }
}

TEST(OfficeWalk, MorePosesAreTheSameWalk) {
  const std::vector<Pose> few = MakeOfficeWalk(50), many = MakeOfficeWalk(100);
  for (size_t i = 0; i < few.size(); ++i) {
    EXPECT_TRUE(few[i].isApprox(many[2 * i], 1e-9)) << i;
  }
}

/// The cubes of 16 cm that contain surface within 5 m of the camera.
std::set<std::array<int, 3>> CubesSeen(const Scene& scene, const Pose& T_W_C) {
  std::set<std::array<int, 3>> cubes;
  const Image<float> depth = Render(scene, kTiny, T_W_C).depth;
  for (int v = 0; v < kTiny.height; ++v) {
    for (int u = 0; u < kTiny.width; ++u) {
      if (!(depth(v, u) < 5)) continue;
      const Vector3d p_W = T_W_C * kTiny.BackProject(u, v, double{depth(v, u)});
      std::array<int, 3> cube;
      for (int i = 0; i < 3; ++i) {
        cube[static_cast<size_t>(i)] = static_cast<int>(std::floor(p_W[i] / 0.16));
      }
      cubes.insert(cube);
    }
  }
  return cubes;
}

// Tests of growing maps rely on this: the beginning and the end of the walk see about the same
// amount of surface, and the end sees mostly new surface.
TEST(OfficeWalk, ItsFirstAndLastTenthSeeAsMuch) {
  const Scene office = MakeOffice();
  constexpr int kPoses = 200, kTenth = kPoses / 10;
  std::set<std::array<int, 3>> map;
  std::array<double, 10> seen{}, fresh{};
  const std::vector<Pose> walk = MakeOfficeWalk(kPoses);
  for (size_t i = 0; i < walk.size(); ++i) {
    const auto cubes = CubesSeen(office, walk[i]);
    seen[i / kTenth] += static_cast<double>(cubes.size()) / kTenth;
    for (const auto& cube : cubes) fresh[i / kTenth] += map.insert(cube).second ? 1.0 / kTenth : 0;
  }
  EXPECT_NEAR(seen.back() / seen.front(), 1, 0.1);
  for (size_t i = 0; i < seen.size(); ++i) {
    EXPECT_GT(fresh[i], 0.5 * fresh[0]) << i;
    EXPECT_NEAR(seen[i] / seen[0], 1, 0.4) << i;
  }
}

TEST(OfficeWalk, TheDetectorTellsObjectsBeyondTheFirst255) {
  const Scene office = MakeOffice();
  std::set<uint16_t> seen;
  size_t found = 0, visible = 0;
  for (const Pose& T_W_C : MakeOfficeWalk(20)) {
    const Image<uint16_t> ids = RenderInstances(office, kTiny, T_W_C);
    const FrameHeader header{.utime = 1, .frame_number = 1, .camera = kTiny, .T_W_C = T_W_C};
    found += SimulateDetections(office, ids, header,
                                {.miss_rate = 0, .mask = {.max_growth = 0}, .min_pixels = 0})
                 .detections.size();
    const std::set<uint16_t> here(ids.pixels().begin(), ids.pixels().end());
    EXPECT_FALSE(here.contains(0)) << "every pixel shows something";
    for (const uint16_t id : here) {
      visible += FindObject(office, id)->kind == ObjectKind::kKnown ? 1 : 0;
    }
    seen.insert(here.begin(), here.end());
  }
  EXPECT_GT(*seen.rbegin(), 255);
  EXPECT_GT(visible, 100u);
  EXPECT_EQ(found, visible);
}

}  // namespace
}  // namespace vismap
