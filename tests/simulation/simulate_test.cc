#include "simulation/simulate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "codecs/frame_codec.h"
#include "codecs/mask_codec.h"
#include "simulation/office.h"
#include "simulation/room.h"
#include "support/cast_ray.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using testing_support::CastRay;

const PinholeCamera kVga{640, 480, 525, 525, 319.5, 239.5};
const PinholeCamera kQuarterVga{160, 120, 131.25, 131.25, 79.5, 59.5};

bool SameDepth(const Image<float>& a, const Image<float>& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  for (size_t i = 0; i < a.size(); ++i) {
    const float x = a.data()[i], y = b.data()[i];
    if (x != y && !(std::isnan(x) && std::isnan(y))) return false;
  }
  return true;
}

Shape At(Shape::Kind kind, const Vector3d& center, const Vector3d& half_size) {
  Shape shape{kind, Pose::Identity(), half_size};
  shape.T_W_O.translation() = center;
  return shape;
}

Scene SphereBeforeWall() {
  const Shape sphere = At(Shape::Kind::kEllipsoid, {0.2, -0.1, 2}, {0.4, 0.4, 0.4});
  const Shape wall = At(Shape::Kind::kBox, {0, 0, 3.5}, {5, 5, 0.5});
  return {"test",
          {{7, "sphere", ClassId{37}, ObjectKind::kKnown, {200, 0, 0}, {sphere}},
           {300, "wall", ClassId::kUnknown, ObjectKind::kStructure, {100, 100, 100}, {wall}}}};
}

TEST(Render, DepthOfASphereIsExact) {
  const Rendering image = Render(SphereBeforeWall(), kVga, Pose::Identity());
  const Vector3d center(0.2, -0.1, 2);
  int on_sphere = 0;
  for (int v = 0; v < 480; v += 3) {
    for (int u = 0; u < 640; u += 3) {
      const Vector3d d = kVga.BackProject(u, v, 1);
      const double a = d.squaredNorm(), b = d.dot(center), c = center.squaredNorm() - 0.16;
      const double root = b * b - a * c;
      const bool hits = root >= 0;
      on_sphere += hits ? 1 : 0;
      EXPECT_EQ(image.object_ids(v, u), hits ? 7 : 300);
      const double expected = hits ? (b - std::sqrt(root)) / a : 3.0;
      EXPECT_NEAR(image.depth(v, u), expected, 1e-6 * expected);
    }
  }
  EXPECT_GT(on_sphere, 3000);
}

TEST(Render, PixelsThatSeeNothingAreNanAndZero) {
  Scene scene = SphereBeforeWall();
  scene.objects.pop_back();
  const Rendering image = Render(scene, kQuarterVga, Pose::Identity());
  EXPECT_TRUE(std::isnan(image.depth(0, 0)));
  EXPECT_EQ(image.object_ids(0, 0), 0);
  EXPECT_EQ(image.color(0, 0), Rgb8{});
}

/// Of every `step`-th pixel of every `step`-th row.
void ExpectEqualsOneRayPerPixel(const Scene& scene, const Pose& T_W_C, int step) {
  const Rendering image = Render(scene, kQuarterVga, T_W_C);
  EXPECT_EQ(RenderInstances(scene, kQuarterVga, T_W_C), image.object_ids);
  for (int v = 0; v < kQuarterVga.height; v += step) {
    for (int u = 0; u < kQuarterVga.width; u += step) {
      const auto hit =
          CastRay(scene, T_W_C.translation(), T_W_C.linear() * kQuarterVga.BackProject(u, v, 1));
      ASSERT_TRUE(hit);
      ASSERT_NEAR(image.depth(v, u), hit->t, 1e-6 * hit->t) << v << " " << u;
      // Where two objects touch, rounding may choose either.
      if (image.object_ids(v, u) != hit->object_id) {
        const Vector3d p_W = T_W_C * kQuarterVga.BackProject(u, v, hit->t);
        const SceneObject* other = FindObject(scene, image.object_ids(v, u));
        ASSERT_NEAR(SignedDistance(*other, p_W), 0, 1e-6) << v << " " << u;
      }
    }
  }
}

TEST(Render, EqualsOneRayPerPixel) {
  const Scene room = MakeRoom(), office = MakeOffice();
  for (const Pose& T_W_C : MakeRoomTour(5)) ExpectEqualsOneRayPerPixel(room, T_W_C, 2);
  for (const Pose& T_W_C : MakeOfficeWalk(9)) ExpectEqualsOneRayPerPixel(office, T_W_C, 9);
}

TEST(Render, PointsLieOnTheSurface) {
  const Scene room = MakeRoom();
  const Pose T_W_C = MakeRoomTour(7)[3];
  const Rendering image = Render(room, kQuarterVga, T_W_C);
  for (int v = 0; v < kQuarterVga.height; v += 2) {
    for (int u = 0; u < kQuarterVga.width; u += 2) {
      const Vector3d p_W = T_W_C * kQuarterVga.BackProject(u, v, double{image.depth(v, u)});
      EXPECT_NEAR(SignedDistance(room, p_W), 0, 2e-6);
    }
  }
}

TEST(Render, IsTheSameForAnyNumberOfThreads) {
  const Scene room = MakeRoom();
  const Pose T_W_C = MakeRoomTour(7)[2];
  const Rendering many = Render(room, kQuarterVga, T_W_C);
  const ThreadLimit one(1);
  const Rendering single = Render(room, kQuarterVga, T_W_C);
  EXPECT_TRUE(SameDepth(many.depth, single.depth));
  EXPECT_EQ(many.color, single.color);
  EXPECT_TRUE(SameDepth(AddDepthNoise(many.depth, kQuarterVga, {}, 1),
                        AddDepthNoise(single.depth, kQuarterVga, {}, 1)));
}

struct Spread {
  double mean = 0, deviation = 0, valid = 0;
};

Spread ErrorsOfAWallAt(float z, const DepthNoise& noise) {
  const Image<float> wall(320, 240, z);
  double sum = 0, squares = 0, count = 0;
  for (uint64_t frame = 0; frame < 2; ++frame) {
    const Image<float> noisy = AddDepthNoise(wall, kVga, noise, frame);
    for (const float seen : noisy.pixels()) {
      if (std::isnan(seen)) continue;
      sum += seen - z;
      squares += (seen - z) * (seen - z);
      ++count;
    }
  }
  const double mean = sum / count;
  return {mean, std::sqrt(squares / count - mean * mean), count / (2 * 320 * 240)};
}

TEST(DepthNoise, HasTheDeviationOfNguyen) {
  for (const float z : {0.8f, 1.3f, 2.1f, 3.3f}) {
    const double expected = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    // The mean over depths around z, because the error at a single depth depends on the disparity
    // step.
    Spread all;
    constexpr int kDepths = 16;
    for (int i = 0; i < kDepths; ++i) {
      const Spread at = ErrorsOfAWallAt(z * (1 + 0.004f * static_cast<float>(i)), {});
      all.mean += at.mean / kDepths;
      all.deviation += at.deviation / kDepths;
      EXPECT_EQ(at.valid, 1.0);
    }
    EXPECT_NEAR(all.deviation, expected, 0.2 * expected) << z;
    EXPECT_LT(std::abs(all.mean), 0.15 * expected) << z;
  }
}

TEST(DepthNoise, SeedAndFrameDecideEverything) {
  const Image<float> wall(64, 48, 2.0f);
  const auto noisy = [&](uint64_t seed, uint64_t frame) {
    return AddDepthNoise(wall, kVga, {.seed = seed}, frame);
  };
  EXPECT_TRUE(SameDepth(noisy(1, 1), noisy(1, 1)));
  EXPECT_FALSE(SameDepth(noisy(1, 1), noisy(1, 2)));
  EXPECT_FALSE(SameDepth(noisy(1, 1), noisy(2, 1)));
  EXPECT_TRUE(SameDepth(AddDepthNoise(wall, kVga, {.enabled = false}, 1), wall));
}

TEST(DepthNoise, DisparitiesComeInSteps) {
  const Image<float> wall(64, 48, 2.0f);
  const double focal_baseline = 525 * 0.075;
  const Image<float> noisy = AddDepthNoise(wall, kVga, {}, 3);
  for (const float z : noisy.pixels()) {
    const double steps = focal_baseline / z / 0.125;
    EXPECT_NEAR(steps, std::round(steps), 1e-4);
  }
}

TEST(DepthNoise, DropsOutOnlyWhereAskedTo) {
  const Scene scene = SphereBeforeWall();
  const Rendering image = Render(scene, kVga, Pose::Identity());
  const Image<float> noisy = AddDepthNoise(image.depth, kVga, {.edge_dropout = 1}, 1);
  int lost = 0;
  for (int v = 1; v < 479; ++v) {
    for (int u = 1; u < 639; ++u) {
      const bool border = image.object_ids(v, u) != image.object_ids(v, u + 1) ||
                          image.object_ids(v, u) != image.object_ids(v, u - 1) ||
                          image.object_ids(v, u) != image.object_ids(v + 1, u) ||
                          image.object_ids(v, u) != image.object_ids(v - 1, u);
      EXPECT_TRUE(!border || std::isnan(noisy(v, u)));
      lost += std::isnan(noisy(v, u)) ? 1 : 0;
      EXPECT_TRUE(border || image.object_ids(v, u) != 300 || !std::isnan(noisy(v, u)));
    }
  }
  EXPECT_LT(lost, 3000);
  EXPECT_EQ(ErrorsOfAWallAt(0.3f, {}).valid, 0);
  EXPECT_EQ(ErrorsOfAWallAt(8.5f, {}).valid, 0);
}

FrameHeader HeaderAt(const Pose& T_W_C, const PinholeCamera& camera, int64_t number) {
  return {.utime = 100 * number,
          .camera_id = CameraId{2},
          .frame_number = number,
          .camera = camera,
          .T_W_C = T_W_C};
}

TEST(RenderFrame, WithoutNoiseIsTheExactDepthInMillimetres) {
  const Scene room = MakeRoom();
  const FrameHeader header = HeaderAt(MakeRoomTour(9)[4], kQuarterVga, 5);
  const Image<float> exact = Render(room, kQuarterVga, header.T_W_C).depth;
  const SensorFrame frame = RenderFrame(room, header, {.enabled = false});
  const Result<RgbdFrame> decoded = DecodeFrame(frame);
  ASSERT_TRUE(decoded) << decoded.error().message;
  for (size_t i = 0; i < exact.size(); ++i) {
    EXPECT_NEAR(decoded->depth.data()[i], exact.data()[i], 0.000501);
  }
  EXPECT_EQ(frame.header.frame_number, 5);
}

TEST(SimulatedDetector, WithoutErrorsGivesTheTrueMasksOfKnownObjects) {
  const Scene room = MakeRoom();
  for (const Pose& T_W_C : MakeRoomTour(6)) {
    const FrameHeader header = HeaderAt(T_W_C, kQuarterVga, 3);
    const Image<uint16_t> ids = RenderInstances(room, kQuarterVga, T_W_C);
    const DetectionSet set = SimulateDetections(
        room, ids, header, {.miss_rate = 0, .mask = {.max_growth = 0}, .min_pixels = 1});
    size_t next = 0;
    for (const SceneObject& object : room.objects) {
      Image<uint8_t> truth(ids.width(), ids.height());
      for (size_t i = 0; i < ids.size(); ++i) truth.data()[i] = ids.data()[i] == object.id;
      const Mask expected = MaskFromImage(truth);
      if (object.kind != ObjectKind::kKnown || expected.inside.empty()) continue;
      ASSERT_LT(next, set.detections.size());
      EXPECT_EQ(set.detections[next].class_id, object.class_id);
      EXPECT_EQ(set.detections[next].mask, expected);
      ++next;
    }
    EXPECT_EQ(next, set.detections.size());
    EXPECT_EQ(set.utime, 300);
    EXPECT_EQ(set.camera_id, CameraId{2});
    EXPECT_EQ(set.frame_number, 3);
  }
}

TEST(SimulatedDetector, ErrorsStayWithinTheirBounds) {
  const Scene scene = SphereBeforeWall();
  const Image<uint16_t> ids = RenderInstances(scene, kVga, Pose::Identity());
  int found = 0;
  std::set<size_t> sizes;
  for (int64_t number = 1; number <= 300; ++number) {
    const DetectionSet set = SimulateDetections(
        scene, ids, HeaderAt(Pose::Identity(), kVga, number), {.miss_rate = 0.2, .mask = {}});
    for (const Detection& detection : set.detections) {
      ++found;
      EXPECT_GE(detection.score, 0.6f);
      EXPECT_LE(detection.score, 1.0f);
      const MaskRuns runs = EncodeMask(detection.mask);
      size_t inside = 0;
      for (size_t i = 1; i < runs.size(); i += 2) inside += runs[i];
      sizes.insert(inside);
    }
  }
  EXPECT_NEAR(found, 240, 30);
  EXPECT_EQ(sizes.size(), 5u);  // from 2 pixels less to 2 more
  const double radius = 0.4 / 2 * 525;
  EXPECT_GT(static_cast<double>(*sizes.begin()), M_PI * (radius - 5) * (radius - 5));
  EXPECT_LT(static_cast<double>(*sizes.rbegin()), M_PI * (radius + 10) * (radius + 10));
}

}  // namespace
}  // namespace vismap
