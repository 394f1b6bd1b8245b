#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/parallel.h"
#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "rectify/lens.h"
#include "rectify/rectified_camera.h"
#include "rectify/rectifier.h"
#include "rectify/rectify_color.h"
#include "rectify/rectify_depth.h"
#include "support/messages.h"
#include "support/mutations.h"
#include "support/naive/rectify_depth.h"

namespace vismap {
namespace {

using ::testing::HasSubstr;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
const PinholeCamera kDepth{212, 120, 106, 106, 105.6, 59.4};
const PinholeCamera kColor{160, 90, 114, 114, 80.2, 45.1};

Pose SmallMove(double roll = 0) {
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(0.01, Eigen::Vector3d(1, -2, 0.5).normalized()))
                      .toRotationMatrix();
  pose.translation() = Eigen::Vector3d(0.015, 0.001, -0.002);
  return pose;
}

bool SameBits(const Image<float>& a, const Image<float>& b) {
  return a.width() == b.width() && a.height() == b.height() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

// Depth of the plane n * p = d [m] as a camera at T_W_C = pose sees it.
double PlaneDepth(const Eigen::Vector3d& n, double d, const Pose& pose,
                  const Eigen::Vector3d& ray) {
  return (d - n.dot(pose.translation())) / n.dot(pose.linear() * ray);
}

Image<float> PlaneImage(const Eigen::Vector3d& n, double d, const Pose& pose,
                        const LensCamera& lens) {
  Image<float> depth(lens.pinhole.width, lens.pinhole.height, kNaN);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const auto ray = Undistort(lens, Eigen::Vector2d(u, v));
      if (ray) depth(v, u) = static_cast<float>(PlaneDepth(n, d, pose, {ray->x(), ray->y(), 1}));
    }
  }
  return depth;
}

// Boxes of random depths and slopes, noise, and pixels without depth.
Image<float> RandomScene(const PinholeCamera& camera, TestRandom* random) {
  Image<float> depth(camera.width, camera.height, 3.0F);
  for (int box = 0; box < 12; ++box) {
    const auto u0 = static_cast<int>(random->Below(static_cast<uint64_t>(camera.width)));
    const auto v0 = static_cast<int>(random->Below(static_cast<uint64_t>(camera.height)));
    const auto size = static_cast<int>(1 + random->Below(50));
    const double near = 0.3 + 2.5 * random->Unit(), slope = 0.04 * (random->Unit() - 0.5);
    for (int v = v0; v < std::min(v0 + size, camera.height); ++v) {
      for (int u = u0; u < std::min(u0 + size, camera.width); ++u)
        depth(v, u) = static_cast<float>(std::max(0.1, near + slope * (u - u0)));
    }
  }
  for (float& z : depth.pixels()) {
    z *= static_cast<float>(1 + 0.004 * (random->Unit() - 0.5));
    if (random->Below(40) == 0) z = kNaN;
  }
  return depth;
}

TEST(Rectify, EqualsTheNaiveOne) {
  TestRandom random(7);
  const LensCamera fisheye{kDepth, Distortion::kEquidistant, {-0.01, 0.004, 0, 0}};
  const LensCamera brown{kDepth, Distortion::kBrownConrady, {-0.1, 0.02, 0.001, 0, 0}};
  for (const double roll : {0.0, 0.3, 1.57, 3.0}) {
    for (const LensCamera& lens : {LensCamera{kDepth}, brown, fisheye}) {
      const DepthTable table = MakeDepthTable(lens, SmallMove(roll), kColor);
      const Image<float> depth = RandomScene(kDepth, &random);
      const Image<float> fast = RectifyDepth(depth, table);
      EXPECT_TRUE(SameBits(fast, naive::RectifyDepth(depth, table))) << roll;
    }
  }
}

// Cameras that measure floats mark pixels without depth by huge values, too.
TEST(Rectify, HugeDepthIsNoDepth) {
  const float most = std::numeric_limits<float>::max();
  const DepthTable table = MakeDepthTable({kDepth}, SmallMove(0.3), kColor);
  TestRandom random(7);
  const Image<float> good = RandomScene(kDepth, &random);
  for (const float huge : {1e6F, 1e20F, 1e36F, most, std::numeric_limits<float>::infinity()}) {
    Image<float> depth = good, missing = good;
    for (int v = 20; v < 90; ++v) {
      for (int u = 30; u < 150; ++u) {
        depth(v, u) = huge;
        missing(v, u) = kNaN;
      }
    }
    EXPECT_TRUE(SameBits(RectifyDepth(depth, table), RectifyDepth(missing, table))) << huge;
  }
}

TEST(Rectify, IsTheSameWithAnyNumberOfThreads) {
  TestRandom random(8);
  const DepthTable table = MakeDepthTable({kDepth}, SmallMove(), kColor);
  const Image<float> depth = RandomScene(kDepth, &random);
  const Image<float> many = RectifyDepth(depth, table);
  const ThreadLimit one(1);
  EXPECT_TRUE(SameBits(many, RectifyDepth(depth, table)));
}

// A plane is seen without holes and exactly, through every lens and at every angle.
TEST(Rectify, PlanesStayPlanesWithoutHoles) {
  const LensCamera lenses[] = {{kDepth},
                               {kDepth, Distortion::kBrownConrady, {-0.1, 0.02, 0.001, 0, 0}},
                               {kDepth, Distortion::kEquidistant, {-0.01, 0.004, 0, 0}}};
  const Eigen::Vector3d normals[] = {{0, 0, 1}, {0.5, 0.1, 1}, {-0.3, 0.7, 1}};
  for (const LensCamera& lens : lenses) {
    for (const Eigen::Vector3d& direction : normals) {
      const Eigen::Vector3d n = direction.normalized();
      const DepthTable table = MakeDepthTable(lens, SmallMove(), kColor);
      // The frame of the target is the world.
      const Image<float> seen = RectifyDepth(PlaneImage(n, 1.5, SmallMove(), lens), table);
      double worst = 0;
      for (int v = 1; v < kColor.height - 1; ++v) {
        for (int u = 1; u < kColor.width - 1; ++u) {
          ASSERT_FALSE(std::isnan(seen(v, u))) << u << " " << v;
          const double expected = PlaneDepth(n, 1.5, Pose::Identity(), kColor.BackProject(u, v, 1));
          worst = std::max(worst, std::abs(seen(v, u) - expected) / expected);
        }
      }
      EXPECT_LT(worst, 2e-5);
    }
  }
}

TEST(Rectify, TheNearerSurfaceIsInFrontAndJumpsAreNotBridged) {
  // A board at 1 m before a wall at 2 m. From 0.2 m beside, a strip of the wall is seen that the
  // board hides from the depth camera.
  Image<float> depth(kDepth.width, kDepth.height, 2.0F);
  for (int v = 30; v < 90; ++v) {
    for (int u = 80; u < 130; ++u) depth(v, u) = 1.0F;
  }
  Pose beside = Pose::Identity();
  beside.translation().x() = 0.2;
  const Image<float> seen = RectifyDepth(depth, MakeDepthTable({kDepth}, beside, kDepth));
  int board = 0, wall = 0, none = 0;
  for (int u = 0; u < kDepth.width; ++u) {
    const float z = seen(60, u);
    if (std::isnan(z)) {
      ++none;
    } else {
      EXPECT_TRUE(std::abs(z - 1) < 1e-4 || std::abs(z - 2) < 1e-4) << z << " at " << u;
      ++(z < 1.5F ? board : wall);
    }
  }
  EXPECT_NEAR(board, 50, 1);
  // The board moves by 21 pixels, the wall by 10.6: behind the board 10.6 pixels are not known, and
  // neither are 10.6 at the border.
  EXPECT_NEAR(none, 21, 2);
}

// A frame taken through distortion, with depth registered to colour.
SensorFrame DistortedFrame() {
  SensorFrame frame = SmallSensorFrame();
  FrameOptics optics;
  optics.color = {kSmallCamera, Distortion::kBrownConrady, {-0.1, 0.02, 0.001, 0, 0}};
  EXPECT_TRUE(SetOptics(optics, true, &frame));
  return frame;
}

TEST(Rectifier, AnIdealFrameIsUnchanged) {
  Rectifier rectifier;
  const SensorFrame frame = SmallSensorFrame();
  const Result<SensorFrame> same = rectifier.Rectify(frame);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->color, frame.color);
  EXPECT_EQ(same->depth, frame.depth);
  EXPECT_EQ(rectifier.Decode(frame)->color, DecodeFrame(frame)->color);
}

TEST(Rectifier, GivesFramesOfAnIdealCamera) {
  Rectifier rectifier;
  const Result<SensorFrame> frame = rectifier.Rectify(DistortedFrame());
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_FALSE(frame->optics);
  EXPECT_TRUE(DecodeFrame(*frame));
  EXPECT_EQ(ReadJpegSize(frame->color)->width, kSmallCamera.width);
  EXPECT_EQ(rectifier.Rectify(DistortedFrame())->depth, frame->depth) << "with kept tables";
}

TEST(Rectifier, DepthInMetresStaysInMetres) {
  Rectifier rectifier;
  SensorFrame frame = DistortedFrame();
  frame.depth_m = DepthInMetres(frame);
  frame.depth = {};
  const Result<SensorFrame> rectified = rectifier.Rectify(frame);
  ASSERT_TRUE(rectified) << rectified.error().message;
  EXPECT_TRUE(rectified->depth.empty());
  EXPECT_EQ(rectified->depth_m.width(), kSmallCamera.width);
}

TEST(Rectifier, DamagedColourCostsOnlyTheColour) {
  Rectifier rectifier;
  SensorFrame frame = DistortedFrame();
  frame.color.resize(40);
  const Result<SensorFrame> rectified = rectifier.Rectify(frame);
  ASSERT_TRUE(rectified) << rectified.error().message;
  EXPECT_TRUE(rectified->color.empty());
  EXPECT_THAT(rectified->color_problem, HasSubstr("frame utime 1000 of camera 3: colour"));
}

TEST(Rectifier, SaysWhatIsWrong) {
  Rectifier rectifier;
  SensorFrame folded = DistortedFrame();
  folded.optics->color.coefficients[0] = -0.9;
  EXPECT_THAT(rectifier.Rectify(folded).error().message,
              HasSubstr("frame utime 1000 of camera 3: color_camera: the distortion folds"));
  SensorFrame other = DistortedFrame();
  other.depth = Image<uint16_t>(32, 24, 1000);
  EXPECT_THAT(rectifier.Rectify(other).error().message,
              HasSubstr("depth is 32x24, but its camera 64x48"));
}

TEST(RectifyColor, ALensOfNoEffectCopiesTheImage) {
  Image<Rgb8> image(64, 48);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u)
      image(v, u) = {static_cast<uint8_t>(4 * u), static_cast<uint8_t>(5 * v), 7};
  }
  EXPECT_EQ(RectifyColor(image, MakeColorTable({kSmallCamera}, kSmallCamera)), image);
}

// A gradient stays where the rays say, also at half the size.
TEST(RectifyColor, FollowsTheRays) {
  const LensCamera lens{
      {128, 96, 100, 100, 63.5, 47.5}, Distortion::kBrownConrady, {-0.1, 0.02, 0.001, 0, 0}};
  Image<Rgb8> image(128, 96);
  for (int v = 0; v < 96; ++v) {
    for (int u = 0; u < 128; ++u)
      image(v, u) = {static_cast<uint8_t>(2 * u), static_cast<uint8_t>(2 * v), 0};
  }
  for (const PinholeCamera& target : {lens.pinhole, PinholeCamera{64, 48, 50, 50, 31.5, 23.5}}) {
    const Image<Rgb8> seen = RectifyColor(image, MakeColorTable(lens, target));
    for (int v = 6; v < target.height - 6; v += 3) {
      for (int u = 6; u < target.width - 6; u += 3) {
        const Eigen::Vector3d ray = target.BackProject(u, v, 1);
        const Eigen::Vector2d pixel = Distort(lens, ray.head<2>());
        EXPECT_NEAR(seen(v, u).r, 2 * pixel.x(), 2);
        EXPECT_NEAR(seen(v, u).g, 2 * pixel.y(), 2);
      }
    }
  }
}

}  // namespace
}  // namespace vismap
