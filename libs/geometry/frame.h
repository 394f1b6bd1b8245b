#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/ids.h"
#include "geometry/camera.h"
#include "geometry/image.h"
#include "geometry/pose.h"

namespace vismap {

/// When, where and with which camera a frame was taken.
struct FrameHeader {
  int64_t utime = 0;      ///< when the images were taken [us]
  CameraId camera_id{0};  ///< which camera took them
  int64_t frame_number =
      -1;  ///< number of the image in its sequence, as detection files count; -1 = none
  PinholeCamera camera;           ///< of the depth image, and of the colour image registered to it
  Pose T_W_C = Pose::Identity();  ///< camera to world, given by the pose source
};

/// A frame as a sensor or a data set delivers it and as messages carry it: colour as JPEG bytes,
/// depth as integers. Decoding it gives the same RgbdFrame in every process, so that live and
/// offline maps are equal bit for bit.
struct SensorFrame {
  FrameHeader header;
  std::vector<uint8_t> color_jpeg;  ///< JPEG of the colour image; empty = a camera without colour
  Image<uint16_t> depth;            ///< HxW, in units of depth_unit_m; 0 = no return
  double depth_unit_m = 0.001;      ///< metres per depth step
  std::string color_problem = {};   ///< why there is no colour, although the camera took some
};

/// A decoded frame, the input of the algorithms.
struct RgbdFrame {
  FrameHeader header;
  Image<float> depth;              ///< HxW [m] along optical z; NaN = no return
  Image<Rgb8> color;               ///< HxW, registered to depth; empty = none
  std::string color_problem = {};  ///< why there is no colour, although the camera took some
};

}  // namespace vismap
