#pragma once

#include <cstdint>
#include <vector>

#include "geometry/camera.h"
#include "geometry/pose.h"

namespace vismap {

/// How a lens departs from the pinhole model. The numbers are those of camera_t.
enum class Distortion : int8_t {
  kNone = 0,
  kBrownConrady = 1,  ///< 4, 5 or 8 coefficients: k1 k2 p1 p2 [k3 [k4 k5 k6]], as OpenCV has them
  kEquidistant = 2,   ///< fisheye (Kannala-Brandt), 4 coefficients: k1 k2 k3 k4
};

/// A camera with a lens: pinhole intrinsics and distortion.
struct LensCamera {
  PinholeCamera pinhole;
  Distortion distortion = Distortion::kNone;
  std::vector<double> coefficients = {};
  friend bool operator==(const LensCamera&, const LensCamera&) = default;
};

/// The cameras of a frame as it was taken, before it is rectified (see rectify/rectifier.h).
struct FrameOptics {
  LensCamera color;                       ///< not used for a frame without colour
  LensCamera depth;                       ///< not used when depth is registered to colour
  bool depth_registered = true;           ///< depth has the pixels of the colour image
  Pose T_color_depth = Pose::Identity();  ///< depth camera to colour camera; not used if registered
};

}  // namespace vismap
