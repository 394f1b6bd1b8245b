#include "plausibility/frame_sample.h"

#include <algorithm>

namespace vismap {

FrameSample MakeFrameSample(const FrameHeader& header, const Image<float>& depth, int max_side) {
  const int side = std::max(depth.width(), depth.height());
  FrameSample sample{header, std::max(1, (side + max_side - 1) / max_side), {}};
  const auto coarse = [&](int pixels) { return (pixels + sample.step - 1) / sample.step; };
  sample.depth = Image<float>(coarse(depth.width()), coarse(depth.height()));
  for (int v = 0; v < sample.depth.height(); ++v) {
    for (int u = 0; u < sample.depth.width(); ++u)
      sample.depth(v, u) = depth(v * sample.step, u * sample.step);
  }
  return sample;
}

}  // namespace vismap
