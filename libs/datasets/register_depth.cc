#include "datasets/register_depth.h"

#include <cmath>

#include "base/require.h"

namespace vismap {
namespace {

constexpr uint16_t kNone = 0, kNoReturn = 65535;

}  // namespace

Image<uint16_t> RegisterDepth(const Image<uint16_t>& depth, double depth_unit_m,
                              const DepthSource& from, const PinholeCamera& color) {
  Require(depth.width() == from.camera.width && depth.height() == from.camera.height,
          "a depth image has the size of its camera");
  Image<uint16_t> seen(color.width, color.height, kNone);
  const Eigen::Vector3d right = from.T_C_D.linear().col(0) / from.camera.fx;
  for (int v = 0; v < depth.height(); ++v) {
    // The ray of pixel (0, v) at unit depth, in the axes of C.
    const Eigen::Vector3d start =
        from.T_C_D.linear() *
        Eigen::Vector3d(-from.camera.cx / from.camera.fx, (v - from.camera.cy) / from.camera.fy, 1);
    for (int u = 0; u < depth.width(); ++u) {
      const uint16_t steps = depth(v, u);
      if (steps == kNone || steps == kNoReturn) continue;
      const Eigen::Vector3d p_C =
          steps * depth_unit_m * (start + u * right) + from.T_C_D.translation();
      const double far = std::round(p_C.z() / depth_unit_m);
      if (!(far >= 1 && far < kNoReturn)) continue;  // behind the camera, or not representable
      const auto x = std::lround(color.fx * p_C.x() / p_C.z() + color.cx);
      const auto y = std::lround(color.fy * p_C.y() / p_C.z() + color.cy);
      if (!seen.Contains(static_cast<int>(y), static_cast<int>(x))) continue;
      uint16_t& nearest = seen(static_cast<int>(y), static_cast<int>(x));
      if (nearest == kNone || far < nearest) nearest = static_cast<uint16_t>(far);
    }
  }
  return seen;
}

}  // namespace vismap
