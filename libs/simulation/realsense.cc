#include "simulation/realsense.h"

#include <cmath>
#include <numbers>

#include "base/require.h"
#include "codecs/color_codec.h"
#include "codecs/frame_codec.h"
#include "rectify/lens.h"
#include "rectify/rectified_camera.h"
#include "rectify/rectify_color.h"

namespace vismap {
namespace {

constexpr double kDepthUnit = 0.001;  // [m]

// Colour as the lens shows it, sampled from an image without distortion that sees a little more.
Image<Rgb8> RenderThroughLens(const Scene& scene, const LensCamera& lens, const Pose& T_W_C) {
  constexpr int kMargin = 96;  // [px]; the lens shows up to 60 px more than its pinhole camera
  constexpr int kOne = 256;    // of ColorSource
  PinholeCamera wide = lens.pinhole;
  wide.width += 2 * kMargin;
  wide.height += 2 * kMargin;
  wide.cx += kMargin;
  wide.cy += kMargin;
  ColorTable table{wide.width, wide.height, 0,
                   Image<ColorSource>(lens.pinhole.width, lens.pinhole.height)};
  for (int v = 0; v < lens.pinhole.height; ++v) {
    for (int u = 0; u < lens.pinhole.width; ++u) {
      const auto ray = Undistort(lens, Eigen::Vector2d(u, v));
      Require(ray.has_value(), "the lens of the simulated camera gives every pixel a ray");
      const Eigen::Vector2d pixel = wide.Project({ray->x(), ray->y(), 1});
      table.sources(v, u) = {static_cast<int32_t>(std::lround(pixel.x() * kOne)),
                             static_cast<int32_t>(std::lround(pixel.y() * kOne))};
    }
  }
  return RectifyColor(Render(scene, wide, T_W_C).color, table);
}

}  // namespace

FrameOptics RealSenseOptics() {
  constexpr double kDegree = std::numbers::pi / 180;
  FrameOptics optics;
  optics.depth.pinhole = {848, 480, 425, 425, 424.3, 238.9};
  optics.color = {{1280, 720, 912, 911, 645.2, 362.4},
                  Distortion::kBrownConrady,
                  {-0.12, 0.05, 0.0008, -0.0005, -0.01}};
  optics.depth_registered = false;
  optics.T_color_depth.linear() =
      Eigen::AngleAxisd(0.4 * kDegree, Eigen::Vector3d(2, -3, 1).normalized()).toRotationMatrix();
  optics.T_color_depth.translation() = Eigen::Vector3d(0.0148, 0.0004, -0.0022);
  return optics;
}

SensorFrame RenderRealSense(const Scene& scene, const FrameHeader& header,
                            const DepthNoise& noise) {
  const FrameOptics optics = RealSenseOptics();
  SensorFrame frame;
  frame.header = header;
  frame.color = EncodeJpeg(RenderThroughLens(scene, optics.color, header.T_W_C));
  const Image<float> depth =
      Render(scene, optics.depth.pinhole, header.T_W_C * optics.T_color_depth).depth;
  frame.depth_unit_m = kDepthUnit;
  frame.depth = DepthInSteps(
      AddDepthNoise(depth, optics.depth.pinhole, noise, static_cast<uint64_t>(header.frame_number)),
      kDepthUnit);
  const auto set = SetOptics(optics, true, &frame);
  Require(set.has_value(), "the simulated cameras are possible");
  return frame;
}

}  // namespace vismap
