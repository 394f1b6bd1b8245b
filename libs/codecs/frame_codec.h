#pragma once

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// Converts the frame of a sensor to the frame that the algorithms use: colour from JPEG to RGB,
/// depth from steps to metres (float), with NaN for no return (0 or 65535). Fails when the camera
/// is implausible, when depth or colour do not have the size of the camera, and when the depth unit
/// is not in (0, 1] m. Of a JPEG that cannot be decoded it says why in `color_problem`; the frame
/// has no colour then.
Result<RgbdFrame> DecodeFrame(const SensorFrame& frame);

/// The depth part of DecodeFrame: steps of `depth_unit_m` to metres; 0 and 65535 become NaN.
Image<float> DepthInMetres(const Image<uint16_t>& depth, double depth_unit_m);

}  // namespace vismap
