#include "geometry/prepare_depth.h"

#include <limits>

namespace vismap {
namespace {

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

}  // namespace vismap
