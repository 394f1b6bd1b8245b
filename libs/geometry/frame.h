#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/ids.h"
#include "geometry/camera.h"
#include "geometry/image.h"
#include "geometry/optics.h"
#include "geometry/pose.h"

namespace vismap {

/// When, where and with which camera a frame was taken.
struct FrameHeader {
  int64_t utime = 0;      ///< when the images were taken [us]
  CameraId camera_id{0};  ///< which camera took them
  int64_t frame_number =
      -1;  ///< number of the image in its sequence, as detection files count; -1 = none
  PinholeCamera camera;  ///< of the depth image and of the colour image registered to it; of a
                         ///< frame that has to be rectified: of what it becomes
  Pose T_W_C = Pose::Identity();  ///< camera to world, given by the pose source
};

/// How the bytes of a colour image are stored. The numbers are those of rgbd_frame_t. Raw pixels
/// stand row by row without padding.
enum class ColorEncoding : int8_t {
  kNone = 0,
  kJpeg = 1,
  kPng = 2,
  kRgb = 3,
  kBgr = 4,
  kRgba = 5,
  kBgra = 6,
  kGrey = 7,
};

/// A frame as a sensor or a data set delivers it and as messages carry it: colour as encoded bytes,
/// depth as integers or metres. Rectifying and decoding it gives the same RgbdFrame in every
/// process, so that live and offline maps are equal bit for bit.
///
/// A frame of an ideal camera (depth registered to colour, no distortion) needs a header, colour
/// and depth. For any other one, SetOptics in rectify/rectified_camera.h sets `optics` and
/// header.camera.
struct SensorFrame {
  FrameHeader header;
  std::vector<uint8_t>
      color;              ///< colour image in `color_encoding`; empty = a camera without colour
  Image<uint16_t> depth;  ///< HxW, in units of depth_unit_m; 0 and 65535 = no return
  double depth_unit_m = 0.001;     ///< metres per step of `depth`
  std::string color_problem = {};  ///< why there is no colour, although the camera took some
  ColorEncoding color_encoding = ColorEncoding::kJpeg;  ///< of `color`, if that is not empty
  Image<float> depth_m = {};  ///< HxW [m], used instead of `depth` when that is empty; NaN,
                              ///< infinity and values <= 0 = no return
  std::optional<FrameOptics> optics = {};  ///< nullopt = an ideal camera, which is header.camera
};

/// A decoded frame, the input of the algorithms.
struct RgbdFrame {
  FrameHeader header;
  Image<float> depth;              ///< HxW [m] along optical z; NaN = no return
  Image<Rgb8> color;               ///< HxW, registered to depth; empty = none
  std::string color_problem = {};  ///< why there is no colour, although the camera took some
  /// The depth before PrepareDepth took out what is beyond the limits; empty = nothing was.
  Image<float> measured_depth = {};
};

}  // namespace vismap
