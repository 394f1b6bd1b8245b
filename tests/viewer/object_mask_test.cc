#include "viewer/object_mask.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "viewer/box_scene.h"
#include "viewer/mask_overlay.h"

namespace vismap {
namespace {

using testing_support::BlockOf;
using testing_support::CubeScene;

const ObjectChoice kCube{InstanceId{7}, {}};

Image<uint8_t> Truth(const CubeScene& scene, const Pose& T_W_C) {
  Image<uint8_t> truth(scene.camera.width, scene.camera.height);
  for (int v = 0; v < truth.height(); ++v) {
    for (int u = 0; u < truth.width(); ++u)
      truth(v, u) = scene.NearestAt(T_W_C, u, v).first == 7 ? 1 : 0;
  }
  return truth;
}

// Pixels that differ although all pixels around them are the same in the truth.
int WrongInside(const Image<uint8_t>& truth, const Image<uint8_t>& mask) {
  int wrong = 0;
  for (int v = 1; v + 1 < truth.height(); ++v) {
    for (int u = 1; u + 1 < truth.width(); ++u) {
      int sum = 0;
      for (int i = 0; i < 9; ++i) sum += truth(v - 1 + i / 3, u - 1 + i % 3);
      if ((sum == 0 && mask(v, u) != 0) || (sum == 9 && mask(v, u) == 0)) ++wrong;
    }
  }
  return wrong;
}

TEST(ObjectMask, IsTheProjectionWithinAPixelWithoutWhatIsHidden) {
  CubeScene scene;
  for (const Pose& T_W_C : {Pose(Pose::Identity()), CubeScene::Tilted()}) {
    const Image<uint8_t> truth = Truth(scene, T_W_C);
    const SurfaceBlock block = BlockOf(scene.parts);
    const ObjectMask mask = DrawObjectMask({&block, 1}, kCube, scene.camera, T_W_C);
    EXPECT_EQ(WrongInside(truth, mask.visible), 0);
    const auto ones = std::count(truth.pixels().begin(), truth.pixels().end(), 1);
    EXPECT_GT(ones, 4000);
    EXPECT_NEAR(mask.pixels, static_cast<double>(ones), 0.02 * static_cast<double>(ones));
    CubeScene alone = scene;
    alone.parts.resize(1);
    const Image<uint8_t> whole = Truth(alone, T_W_C);
    const auto all = std::count(whole.pixels().begin(), whole.pixels().end(), 1);
    EXPECT_NEAR(mask.pixels_alone, static_cast<double>(all), 0.02 * static_cast<double>(all));
    EXPECT_LT(mask.pixels, mask.pixels_alone - 200);  // the post hides a part
  }
}

TEST(ObjectMask, ChoosesByInstanceOrByTheSegmentsThatHaveNone) {
  CubeScene scene;
  scene.parts[0].instance = 0;
  const SurfaceBlock block = BlockOf(scene.parts);
  const Pose T_W_C = Pose::Identity();
  const auto pixels = [&](const ObjectChoice& object) {
    return DrawObjectMask({&block, 1}, object, scene.camera, T_W_C).pixels;
  };
  EXPECT_GT(pixels({InstanceId::kNone, {3, 70}}), 1000);
  EXPECT_EQ(pixels(kCube), 0);
  EXPECT_EQ(pixels({InstanceId::kNone, {90}}), 0);  // the post has an instance
  EXPECT_GT(pixels({InstanceId{9}, {}}), 1000);
  EXPECT_EQ(SampleObject({&block, 1}, {InstanceId::kNone, {70}}, 5).size(), 5U);
  EXPECT_EQ(SampleObject({&block, 1}, {InstanceId::kNone, {70}}, 100).size(), 8U);
  EXPECT_TRUE(SampleObject({&block, 1}, kCube, 100).empty());
}

TEST(ObjectMask, NothingIsDrawnOfWhatIsBehindTheCameraOrBesideThePicture) {
  CubeScene scene;
  const SurfaceBlock block = BlockOf(scene.parts);
  for (const double angle : {1.6, 3.1, -1.6}) {
    Pose T_W_C = Pose::Identity();
    T_W_C.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
    EXPECT_EQ(DrawObjectMask({&block, 1}, kCube, scene.camera, T_W_C).pixels_alone, 0) << angle;
  }
}

// What the depth camera measured from this pose, every `step`-th pixel.
Image<uint16_t> Measure(const CubeScene& scene, const Pose& T_W_C, int step) {
  Image<uint16_t> depth(scene.camera.width / step, scene.camera.height / step);
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u)
      depth(v, u) = static_cast<uint16_t>(1000 * scene.NearestAt(T_W_C, u * step, v * step).second);
  }
  return depth;
}

TEST(ObjectMask, KeepsWhatTheCameraMeasured) {
  CubeScene scene;
  const Pose T_W_C = CubeScene::Tilted();
  const SurfaceBlock block = BlockOf(scene.parts);
  const ObjectMask drawn = DrawObjectMask({&block, 1}, kCube, scene.camera, T_W_C);
  ObjectMask mask = drawn;
  KeepMeasured(Measure(scene, T_W_C, 4), 4, 1, &mask);
  EXPECT_EQ(mask.visible, drawn.visible);
  mask = drawn;
  KeepMeasured(Image<uint16_t>(80, 60), 4, 1, &mask);
  EXPECT_EQ(mask.visible, drawn.visible) << "nothing was measured";

  CubeScene before = scene;  // the cube came later
  before.parts.erase(before.parts.begin());
  mask = drawn;
  KeepMeasured(Measure(before, T_W_C, 4), 4, 1, &mask);
  EXPECT_EQ(mask.pixels, 0);

  CubeScene crowded = scene;  // somebody stood before the left half
  crowded.parts.push_back({{Eigen::Vector3d(-1, -1, 0.8), Eigen::Vector3d(-0.1, 1, 0.9)}, 11, 5});
  mask = drawn;
  KeepMeasured(Measure(crowded, T_W_C, 4), 4, 1, &mask);
  const Image<uint8_t> truth = Truth(crowded, T_W_C);
  const auto left = std::count(truth.pixels().begin(), truth.pixels().end(), 1);
  EXPECT_GT(left, 1000);
  EXPECT_NEAR(mask.pixels, static_cast<double>(left), 0.2 * static_cast<double>(left));
}

TEST(MaskOverlay, TintsTheInsideAndDrawsTheEdge) {
  Image<uint8_t> mask(32, 24);
  for (int v = 6; v < 18; ++v) std::fill(mask.row(v) + 8, mask.row(v) + 24, uint8_t{1});
  Image<Rgb8> picture(64, 48, Rgb8{100, 100, 100});
  const Rgb8 green{0, 200, 0};
  DrawMask(mask, green, &picture);
  EXPECT_EQ(picture(2, 2), (Rgb8{100, 100, 100}));
  EXPECT_EQ(picture(24, 32), (Rgb8{55, 145, 55}));
  EXPECT_EQ(picture(24, 15), green);  // the first column inside
  EXPECT_EQ(picture(24, 14), (Rgb8{100, 100, 100}));
  const Image<Rgb8> small = ShrinkPicture(picture, 5);
  EXPECT_EQ(small.width(), 12);
  EXPECT_EQ(small.height(), 9);
  EXPECT_EQ(small(0, 0), (Rgb8{100, 100, 100}));
}

}  // namespace
}  // namespace vismap
