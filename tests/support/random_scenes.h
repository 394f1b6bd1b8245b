#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "geometry/frame.h"
#include "support/analytic_depth.h"

namespace vismap::testing_support {

/// Pseudo-random numbers that depend on the seed only.
class RandomNumbers {
 public:
  explicit RandomNumbers(uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ull + 1) {}
  /// In [low, high).
  double Real(double low, double high) {
    return low + (high - low) * static_cast<double>(Bits() >> 11) / 9007199254740992.0;
  }
  /// In [low, high].
  int Whole(int low, int high) {
    return low + static_cast<int>(Bits() % static_cast<uint64_t>(high - low + 1));
  }
  bool Chance(double probability) { return Real(0, 1) < probability; }

 private:
  uint64_t Bits() {  // splitmix64
    uint64_t x = (state_ += 0x9E3779B97F4A7C15ull);
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return x ^ (x >> 31);
  }
  uint64_t state_;
};

/// A camera with a wide angle of view and this image size.
inline PinholeCamera RandomCamera(int width, int height, RandomNumbers* random) {
  const double focal = std::max(width, 8) * random->Real(0.7, 1.1);
  return {width,
          height,
          focal,
          focal * random->Real(0.95, 1.05),
          0.5 * width - 0.5,
          0.5 * height - 0.3};
}

/// Planes and balls between 0.4 and 6 m.
inline TestScene RandomScene(RandomNumbers* random) {
  TestScene scene;
  const auto real = [&](double low, double high) { return random->Real(low, high); };
  for (int i = random->Whole(1, 4); i > 0; --i) {
    const Eigen::Vector3d normal(real(-1, 1), real(-1, 1), real(0.1, 1));
    scene.planes.push_back({normal.normalized(), real(0.4, 4)});
  }
  for (int i = random->Whole(0, 12); i > 0; --i) {
    const double z = real(0.5, 5);
    scene.spheres.push_back({{z * real(-0.6, 0.6), z * real(-0.5, 0.5), z}, real(0.03, 0.5)});
  }
  return scene;
}

/// Rectangles without depth, others with a depth of their own, and single pixels of any depth.
inline void Disturb(RandomNumbers* random, Image<float>* depth) {
  const auto paint = [&](float value, int u0, int v0, int width, int height) {
    for (int v = v0; v < std::min(depth->height(), v0 + height); ++v) {
      for (int u = u0; u < std::min(depth->width(), u0 + width); ++u) (*depth)(v, u) = value;
    }
  };
  const int w = depth->width(), h = depth->height();
  const auto somewhere = [&](float value, int largest) {
    const int u0 = random->Whole(0, w - 1), v0 = random->Whole(0, h - 1);
    paint(value, u0, v0, random->Whole(1, largest), random->Whole(1, largest));
  };
  const float values[] = {std::numeric_limits<float>::quiet_NaN(), 0.0F, -1.0F, 0.05F, 12.0F};
  for (int i = random->Whole(0, 8); i > 0; --i)
    somewhere(values[random->Whole(0, 4)], std::max(1, w / 5));
  for (int i = random->Whole(0, 8); i > 0; --i)
    somewhere(static_cast<float>(random->Real(0.3, 5)), std::max(1, w / 4));
  for (int i = w * h / 50; i > 0; --i) somewhere(static_cast<float>(random->Real(0.1, 10)), 1);
}

/// Depth of a random scene as a sensor measures it.
inline Image<float> RandomDepth(const PinholeCamera& camera, RandomNumbers* random) {
  const Image<float> exact = Render(RandomScene(random), camera).depth;
  const auto seed = static_cast<uint64_t>(random->Whole(1, 1 << 30));
  Image<float> depth =
      random->Chance(0.2) ? exact : AddNoise(exact, KinectNoise(), random->Whole(1, 4), seed);
  if (random->Chance(0.8)) Disturb(random, &depth);
  return depth;
}

/// A coloured frame of a random scene, taken from near the origin.
inline RgbdFrame RandomFrame(const PinholeCamera& camera, RandomNumbers* random) {
  RgbdFrame frame;
  frame.header.camera = camera;
  const Eigen::Vector3d axis(random->Real(-1, 1), random->Real(-1, 1), random->Real(-1, 1));
  frame.header.T_W_C.linear() =
      Eigen::AngleAxisd(random->Real(-0.4, 0.4), axis.normalized()).toRotationMatrix();
  for (int i = 0; i < 3; ++i) frame.header.T_W_C.translation()[i] = random->Real(-0.2, 0.2);
  frame.depth = RandomDepth(camera, random);
  if (random->Chance(0.8)) {
    frame.color = Image<Rgb8>(camera.width, camera.height);
    const auto byte = [&] { return static_cast<uint8_t>(random->Whole(0, 255)); };
    for (Rgb8& color : frame.color.pixels()) color = {byte(), byte(), byte()};
  }
  return frame;
}

/// Image sizes that leave incomplete strips, tiles and bands at the border.
inline constexpr std::pair<int, int> kOddSizes[] = {{1, 1},   {2, 1},   {1, 3},    {15, 4},
                                                    {16, 16}, {17, 33}, {31, 65},  {32, 7},
                                                    {37, 29}, {64, 48}, {161, 119}};

}  // namespace vismap::testing_support
