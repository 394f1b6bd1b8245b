#include "plausibility/frame_sample.h"

#include <algorithm>
#include <cmath>

namespace vismap {
namespace {

// Combines the 3x3 samples around each one; fmin and fmax pass NaN over.
template <typename Combine>
Image<float> AroundEach(const Image<float>& depth, const Combine& combine) {
  Image<float> result = depth;
  for (int v = 0; v < depth.height(); ++v) {
    for (int u = 0; u < depth.width(); ++u) {
      for (int y = std::max(0, v - 1); y <= std::min(depth.height() - 1, v + 1); ++y) {
        for (int x = std::max(0, u - 1); x <= std::min(depth.width() - 1, u + 1); ++x)
          result(v, u) = combine(result(v, u), depth(y, x));
      }
    }
  }
  return result;
}

}  // namespace

FrameSample MakeFrameSample(const FrameHeader& header, const Image<float>& depth, int max_side) {
  const int side = std::max(depth.width(), depth.height());
  FrameSample sample{header, std::max(1, (side + max_side - 1) / max_side), {}, {}, {}};
  const auto coarse = [&](int pixels) { return (pixels + sample.step - 1) / sample.step; };
  sample.depth = Image<float>(coarse(depth.width()), coarse(depth.height()));
  for (int v = 0; v < sample.depth.height(); ++v) {
    for (int u = 0; u < sample.depth.width(); ++u)
      sample.depth(v, u) = depth(v * sample.step, u * sample.step);
  }
  sample.nearest = AroundEach(sample.depth, [](float a, float b) { return std::fmin(a, b); });
  sample.farthest = AroundEach(sample.depth, [](float a, float b) { return std::fmax(a, b); });
  return sample;
}

}  // namespace vismap
