#include "geometry/prepare_depth.h"

#include <limits>

namespace vismap {
namespace {

// Whether some depth is outside of the limits. Infinity is beyond them, NaN is no depth.
bool HasDepthOutside(float nearest, float farthest, const Image<float>& depth) {
  int32_t outside = 0;
  for (const float z : depth.pixels()) outside |= (z < nearest) | (z > farthest);
  return outside != 0;
}

void LimitDepth(float nearest, float farthest, Image<float>* depth) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (float& z : depth->pixels()) z = z >= nearest && z <= farthest ? z : kNaN;
}

}  // namespace

PrepareDepthOptions PrepareDepthOptionsOf(const SurfaceOptions& options) {
  return {options.min_depth_m, options.max_depth_m, HoleOptionsOf(options)};
}

void PrepareDepth(const PrepareDepthOptions& options, Image<float>* depth) {
  LimitDepth(static_cast<float>(options.min_depth_m), static_cast<float>(options.max_depth_m),
             depth);
  FillHoles(options.holes, depth);
}

void PrepareDepth(const PrepareDepthOptions& options, RgbdFrame* frame) {
  const auto nearest = static_cast<float>(options.min_depth_m);
  const auto farthest = static_cast<float>(options.max_depth_m);
  if (HasDepthOutside(nearest, farthest, frame->depth)) {
    frame->measured_depth = frame->depth;
    LimitDepth(nearest, farthest, &frame->depth);
  }
  FillHoles(options.holes, &frame->depth);
}

}  // namespace vismap
