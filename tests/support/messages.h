#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "codecs/color_codec.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

inline constexpr PinholeCamera kSmallCamera{64, 48, 52, 52, 31.5, 23.5};

/// A small frame with slanted depth, a hole in it, and a colour image.
inline SensorFrame SmallSensorFrame(int64_t utime = 1000, int camera = 3) {
  SensorFrame frame;
  frame.header.utime = utime;
  frame.header.camera_id = CameraId{camera};
  frame.header.frame_number = 17;
  frame.header.camera = kSmallCamera;
  frame.header.T_W_C.translation() = Eigen::Vector3d(1, 2, 3);
  frame.header.T_W_C.linear() = Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitY()).toRotationMatrix();
  frame.depth = Image<uint16_t>(kSmallCamera.width, kSmallCamera.height);
  Image<Rgb8> color(kSmallCamera.width, kSmallCamera.height);
  for (int v = 0; v < kSmallCamera.height; ++v) {
    for (int u = 0; u < kSmallCamera.width; ++u) {
      frame.depth(v, u) = static_cast<uint16_t>(u < 8 && v < 8 ? 0 : 1500 + 3 * u + v);
      color(v, u) = {static_cast<uint8_t>(4 * u), static_cast<uint8_t>(5 * v), 90};
    }
  }
  frame.color = EncodeJpeg(color);
  return frame;
}

inline Mask BoxMask(int u0, int v0, int width, int height) {
  return {kSmallCamera.width, kSmallCamera.height, u0, v0, Image<uint8_t>(width, height, 1)};
}

inline DetectionSet SmallDetections(int64_t utime = 1000, int camera = 3) {
  DetectionSet set{utime, CameraId{camera}, 17, {}};
  set.detections.push_back({ClassId{62}, 0.75F, BoxMask(10, 5, 20, 30)});
  set.detections.push_back({ClassId{1}, 1.0F, BoxMask(40, 0, 24, 48)});
  return set;
}

}  // namespace vismap
