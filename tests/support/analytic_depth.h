#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "geometry/image.h"
#include "geometry/noise_model.h"

namespace vismap {

inline constexpr PinholeCamera kVga{640, 480, 525, 525, 319.5, 239.5};

/// Points p with normal . p = offset, where `inside(p)`; in the camera frame.
struct TestPlane {
  Eigen::Vector3d normal;
  double offset;
  bool (*inside)(const Eigen::Vector3d&) = [](const Eigen::Vector3d&) { return true; };
};
struct TestSphere {
  Eigen::Vector3d center;
  double radius;
};

/// Shapes in the camera frame. They are numbered from 0, planes first, then spheres.
struct TestScene {
  std::vector<TestPlane> planes;
  std::vector<TestSphere> spheres;
};

/// Exact depth (NaN = nothing hit) and the number of the shape seen (-1 = none).
struct TestView {
  Image<float> depth;
  Image<int> shape;
};

inline TestView Render(const TestScene& scene, const PinholeCamera& camera = kVga) {
  TestView view{Image<float>(camera.width, camera.height, std::numeric_limits<float>::quiet_NaN()),
                Image<int>(camera.width, camera.height, -1)};
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d ray = camera.BackProject(u, v, 1.0);
      double nearest = std::numeric_limits<double>::infinity();
      int number = 0;
      const auto hit = [&](double z) {
        if (z > 0 && z < nearest) {
          nearest = z;
          view.depth(v, u) = static_cast<float>(z);
          view.shape(v, u) = number;
        }
      };
      for (const TestPlane& plane : scene.planes) {
        const double z = plane.offset / plane.normal.dot(ray);
        if (std::isfinite(z) && plane.inside(z * ray)) hit(z);
        ++number;
      }
      for (const TestSphere& sphere : scene.spheres) {
        const double a = ray.squaredNorm(), b = ray.dot(sphere.center);
        const double root =
            b * b - a * (sphere.center.squaredNorm() - sphere.radius * sphere.radius);
        if (root >= 0) hit((b - std::sqrt(root)) / a);
        ++number;
      }
    }
  }
  return view;
}

/// Normally distributed numbers that are the same on every machine (splitmix64 and Box-Muller).
class TestNoise {
 public:
  explicit TestNoise(uint64_t seed) : state_(seed) {}
  double Next() {
    const double r = std::sqrt(-2 * std::log(Uniform()));
    return r * std::cos(2 * 3.14159265358979323846 * Uniform());
  }

 private:
  double Uniform() {
    uint64_t x = (state_ += 0x9E3779B97F4A7C15ull);
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ull;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBull;
    return (static_cast<double>((x ^ (x >> 31)) >> 11) + 0.5) / 9007199254740992.0;
  }
  uint64_t state_;
};

/// Depth as a sensor of this model measures it: noise per block of `block` pixels, interpolated
/// bilinearly between their centres, then rounded to disparity steps.
inline Image<float> AddNoise(const Image<float>& depth, const DepthNoiseModel& model, int block,
                             uint64_t seed) {
  TestNoise noise(seed);
  Image<float> grid(depth.width() / block + 2, depth.height() / block + 2);
  for (float& value : grid.pixels()) value = static_cast<float>(noise.Next());
  Image<float> out = depth;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      const double z = depth(v, u);
      if (!(z > 0)) continue;
      const int x = u / block, y = v / block;
      const double a = static_cast<double>(u % block) / block;
      const double b = static_cast<double>(v % block) / block;
      const double deviate = (1 - b) * ((1 - a) * grid(y, x) + a * grid(y, x + 1)) +
                             b * ((1 - a) * grid(y + 1, x) + a * grid(y + 1, x + 1));
      double noisy = z + model.AxialSigma(z) * deviate;
      if (model.disparity_step_per_m > 0) {  // one step of inverse depth = disparity_step_per_m
        noisy =
            1 / (std::round(1 / (noisy * model.disparity_step_per_m)) * model.disparity_step_per_m);
      }
      out(v, u) = static_cast<float>(noisy);
    }
  }
  return out;
}

}  // namespace vismap
