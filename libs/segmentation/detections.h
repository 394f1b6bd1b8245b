#pragma once

#include <cstdint>
#include <vector>

#include "base/ids.h"
#include "geometry/image.h"

namespace vismap {

/// A binary mask of one frame, stored as its bounding box: pixel (u, v) of the image is in the mask
/// when inside(v - v0, u - u0) != 0. The box may be empty or reach beyond the image.
struct Mask {
  int image_width = 0;
  int image_height = 0;
  int u0 = 0;
  int v0 = 0;
  Image<uint8_t> inside;  ///< 0 or 1

  bool Contains(int v, int u) const {
    return inside.Contains(v - v0, u - u0) && inside(v - v0, u - u0) != 0;
  }
  friend bool operator==(const Mask&, const Mask&) = default;
};

/// One 2-D instance mask of one frame.
struct Detection {
  ClassId class_id = ClassId::kUnknown;
  float score = 0;  ///< detector confidence in [0, 1]
  Mask mask;
};

/// All detections of one frame; empty = the detector processed the frame and found nothing.
struct DetectionSet {
  int64_t utime = 0;  ///< of the frame [us]
  CameraId camera_id{0};
  int64_t frame_number = -1;
  std::vector<Detection> detections;
};

}  // namespace vismap
