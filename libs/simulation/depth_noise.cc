#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/require.h"
#include "codecs/color_codec.h"
#include "simulation/noise_field.h"
#include "simulation/simulate.h"

namespace vismap {
namespace {

constexpr float kNoReturn = std::numeric_limits<float>::quiet_NaN();

/// The depth that the sensor measures [m]: `z` plus a normal error, rounded to the nearest
/// disparity step. `error` is a normal number of deviation 1; it is scaled so that the error and
/// the rounding together have the axial `deviation` [m]. NaN if the disparity is below one step.
double Measure(double z, double error, double focal_baseline, double step, double deviation) {
  const double depth_step = z * z * step / focal_baseline;
  const double rest = deviation * deviation - depth_step * depth_step / 12;
  const double seen = z + error * std::sqrt(std::max(rest, 0.0));
  if (step == 0) return seen;
  const double steps = std::floor(focal_baseline / seen / step + 0.5);
  return steps > 0 ? focal_baseline / (steps * step) : double{kNoReturn};
}

/// Differences of depth between a pixel and its two neighbours along a row or a column [m]; NaN if
/// a neighbour has no depth, 0 if it is outside of the image.
struct Steps {
  double before, after;

  double LargestMagnitude() const { return std::fmax(std::abs(before), std::abs(after)); }
  double Slope() const { return 0.5 * (after - before); }
};

Steps StepsAt(const Image<float>& depth, int v, int u, int dv, int du) {
  const auto step = [&](int sign) {
    const int row = v + sign * dv, column = u + sign * du;
    return depth.Contains(row, column) ? double{depth(row, column)} - double{depth(v, u)} : 0.0;
  };
  return {step(-1), step(1)};
}

/// Whether a pixel is beside a depth discontinuity or beside a pixel without depth.
bool IsBesideStep(const Steps& across, const Steps& down, double z) {
  const double limit = std::max(0.05, 0.03 * z);
  return !(std::max(across.LargestMagnitude(), down.LargestMagnitude()) <= limit) ||
         std::isnan(across.Slope()) || std::isnan(down.Slope());
}

/// |cos| of the angle between the view ray and the surface normal. `zu`, `zv`: derivatives of depth
/// [m/px].
double ViewCosine(const PinholeCamera& camera, int v, int u, double z, double zu, double zv) {
  const double x = u - camera.cx, y = v - camera.cy;
  const Eigen::Vector3d normal(camera.fx * zu, camera.fy * zv, -(z + x * zu + y * zv));
  const Eigen::Vector3d ray(x / camera.fx, y / camera.fy, 1);
  return z / (normal.norm() * ray.norm());
}

}  // namespace

Image<float> AddDepthNoise(const Image<float>& depth, const PinholeCamera& camera,
                           const DepthNoise& noise, uint64_t frame) {
  if (!noise.enabled) return depth;
  Require(noise.correlation >= 1, "noise varies over at least one pixel");
  Require(noise.scale >= 0, "the scale of the depth noise is not negative");
  const uint64_t key = Mix(noise.seed, frame);
  const NoiseField field(depth.width(), depth.height(), noise.correlation, Mix(key, 1));
  const uint64_t dropout_key = Mix(key, 2);
  Image<float> noisy(depth.width(), depth.height(), kNoReturn);
  ParallelFor(static_cast<size_t>(depth.height()), 16, [&](size_t row) {
    const int v = static_cast<int>(row);
    for (int u = 0; u < depth.width(); ++u) {
      const double z = depth(v, u);
      if (!(z >= noise.min_depth && z <= noise.max_depth)) continue;  // out of range, or NaN
      const Steps across = StepsAt(depth, v, u, 0, 1), down = StepsAt(depth, v, u, 1, 0);
      if (IsBesideStep(across, down, z)) {
        const uint64_t pixel =
            row * static_cast<uint64_t>(depth.width()) + static_cast<uint64_t>(u);
        if (Uniform(Mix(dropout_key, pixel)) < noise.edge_dropout) continue;  // edge dropout
      } else if (ViewCosine(camera, v, u, z, across.Slope(), down.Slope()) < noise.grazing_cosine) {
        continue;  // grazing view
      }
      noisy(v, u) = static_cast<float>(Measure(z, field.At(v, u), camera.fx * noise.baseline,
                                               noise.scale * noise.disparity_step,
                                               noise.scale * noise.axial.AxialSigma(z)));
    }
  });
  return noisy;
}

SensorFrame RenderFrame(const Scene& scene, const FrameHeader& header, const DepthNoise& noise) {
  const Rendering image = Render(scene, header.camera, header.T_W_C);
  const Image<float> depth =
      AddDepthNoise(image.depth, header.camera, noise, static_cast<uint64_t>(header.frame_number));
  SensorFrame frame{.header = header,
                    .color = EncodeJpeg(image.color),
                    .depth = Image<uint16_t>(depth.width(), depth.height()),
                    .depth_unit_m = 0.001};
  std::transform(depth.pixels().begin(), depth.pixels().end(), frame.depth.pixels().begin(),
                 [](float z) {
                   const double mm = std::floor(1000.0 * double{z} + 0.5);
                   return mm >= 1 && mm < 65535 ? static_cast<uint16_t>(mm) : uint16_t{0};
                 });
  return frame;
}

}  // namespace vismap
