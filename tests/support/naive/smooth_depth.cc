#include "support/naive/smooth_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vismap::naive {
namespace {

float At(const Image<float>& image, int v, int u) {
  return image.Contains(v, u) ? image(v, u) : std::numeric_limits<float>::quiet_NaN();
}

/// The largest bend that counts as noise at a pixel of inverse depth w [1/m].
float LargestBend(float w, const DepthNoiseModel& noise, double sigmas) {
  const float past = std::max(1.0F / w - static_cast<float>(noise.axial_offset_m), 0.0F);
  const float axial = static_cast<float>(noise.axial_base_m) +
                      static_cast<float>(noise.axial_quadratic_per_m) * past * past;
  const double step = noise.disparity_step_per_m;
  const float sigma = axial * (w * w), rounding = static_cast<float>(step * step / 12);
  return static_cast<float>(sigmas * std::sqrt(6.0)) * std::sqrt(sigma * sigma + rounding);
}

/// The mean over pairs along one direction, at one pixel.
float MeanOfPairs(const Image<float>& inverse, int v, int u, int dv, int du,
                  const DepthNoiseModel& noise, const DepthSmoothing& options) {
  const float middle = inverse(v, u), limit = LargestBend(middle, noise, options.sigmas);
  float sum = middle, number = 1;
  for (int k = 1; k <= options.radius_px; ++k) {
    const float pair = At(inverse, v - k * dv, u - k * du) + At(inverse, v + k * dv, u + k * du);
    if (!(std::abs(pair - 2.0F * middle) <= limit)) break;
    sum += pair;
    number += 2;
  }
  return sum / number;
}

}  // namespace

Image<float> SmoothDepth(const Image<float>& depth, const DepthNoiseModel& noise,
                         const DepthSmoothing& options) {
  if (options.radius_px == 0) return depth;
  const int width = depth.width(), height = depth.height();
  Image<float> inverse(width, height), rows(width, height), out(width, height);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) inverse(v, u) = 1.0F / depth(v, u);
  }
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) rows(v, u) = MeanOfPairs(inverse, v, u, 0, 1, noise, options);
  }
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u)
      out(v, u) = 1.0F / MeanOfPairs(rows, v, u, 1, 0, noise, options);
  }
  return out;
}

}  // namespace vismap::naive
