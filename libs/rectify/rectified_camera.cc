#include "rectify/rectified_camera.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "rectify/lens.h"

namespace vismap {
namespace {

size_t PixelsOf(const PinholeCamera& camera) {
  return static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height);
}

bool UsesDepthCamera(const FrameOptics& optics, bool has_color) {
  return !has_color || !optics.depth_registered;
}

PinholeCamera Scaled(const PinholeCamera& camera, double scale) {
  PinholeCamera scaled = camera;
  scaled.width = std::max(1, static_cast<int>(std::lround(camera.width * scale)));
  scaled.height = std::max(1, static_cast<int>(std::lround(camera.height * scale)));
  const double sx = double(scaled.width) / camera.width;
  const double sy = double(scaled.height) / camera.height;
  scaled.fx *= sx;
  scaled.fy *= sy;
  scaled.cx = (camera.cx + 0.5) * sx - 0.5;
  scaled.cy = (camera.cy + 0.5) * sy - 0.5;
  return scaled;
}

Result<void> CheckField(const char* field, const LensCamera& lens) {
  if (const auto checked = CheckLens(lens); !checked)
    return Fail(std::string(field) + ": " + checked.error().message);
  return {};
}

Result<void> CheckBaseline(const Pose& T_color_depth) {
  const auto pose = MakePose(T_color_depth.matrix());
  if (!pose) return Fail("T_color_depth: " + pose.error().message);
  const double length = T_color_depth.translation().norm();
  if (length <= kMaxBaseline) return {};
  return Fail("T_color_depth: the cameras are " + std::to_string(length) +
              " m apart; expected at most " + std::to_string(int(kMaxBaseline)) + " m, in metres");
}

}  // namespace

Result<void> CheckOptics(const FrameOptics& optics, bool has_color) {
  if (has_color) {
    if (const auto color = CheckField("color_camera", optics.color); !color) return color;
  }
  if (!UsesDepthCamera(optics, has_color)) return {};
  if (const auto depth = CheckField("depth_camera", optics.depth); !depth) return depth;
  return has_color ? CheckBaseline(optics.T_color_depth) : Result<void>();
}

bool IsIdeal(const FrameOptics& optics, bool has_color) {
  if (!has_color) return IsPinhole(optics.depth);
  if (!IsPinhole(optics.color)) return false;
  return optics.depth_registered ||
         (IsPinhole(optics.depth) && optics.depth.pinhole == optics.color.pinhole &&
          optics.T_color_depth.matrix() == Eigen::Matrix4d::Identity());
}

PinholeCamera RectifiedCamera(const FrameOptics& optics, bool has_color) {
  if (!has_color) return optics.depth.pinhole;
  const PinholeCamera& color = optics.color.pinhole;
  const PinholeCamera& depth = optics.depth.pinhole;
  if (optics.depth_registered) return color;
  return Scaled(color, std::min(1.0, std::max(depth.fx / color.fx, depth.fy / color.fy)));
}

Result<void> SetOptics(const FrameOptics& optics, bool has_color, SensorFrame* frame) {
  if (const auto checked = CheckOptics(optics, has_color); !checked) return checked;
  const PinholeCamera camera = RectifiedCamera(optics, has_color);
  frame->optics.reset();
  if (!IsIdeal(optics, has_color)) {
    const size_t pixels =
        std::max(PixelsOf(camera),
                 UsesDepthCamera(optics, has_color) ? PixelsOf(optics.depth.pinhole) : size_t{0});
    if (pixels > kMaxRectifiedPixels) {
      return Fail("depth to be rectified has " + std::to_string(pixels) +
                  " pixels; expected at most " + std::to_string(kMaxRectifiedPixels));
    }
    frame->optics = optics;
  }
  frame->header.camera = camera;
  return {};
}

}  // namespace vismap
