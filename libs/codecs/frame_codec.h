#pragma once

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// The one way from a sensor's frame to the frame the algorithms see: colour from JPEG to RGB,
/// depth from steps to metres (float), NaN where it is 0 or 65535 (both mean no return). Fails when
/// the camera is implausible, when depth has not the camera's size, when colour has not the size of
/// depth (naming both), when the depth unit is not in (0, 1] m, or when the JPEG is broken.
Result<RgbdFrame> DecodeFrame(const SensorFrame& frame);

/// The depth part of DecodeFrame: steps of `depth_unit_m` to metres; 0 and 65535 become NaN.
Image<float> DepthInMetres(const Image<uint16_t>& depth, double depth_unit_m);

}  // namespace vismap
