#pragma once

#include <string>

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// Converts the frame of an ideal camera to the frame that the algorithms use: colour to RGB, depth
/// to metres (float), with NaN for no return. Fails when the frame has to be rectified first
/// (SensorFrame::optics), when the camera is implausible, when depth or colour do not have the size
/// of the camera, and when the depth unit is not in (0, 1] m. Of colour that cannot be decoded it
/// says why in `color_problem`; the frame has no colour then.
Result<RgbdFrame> DecodeFrame(const SensorFrame& frame);

/// Depth of a frame in metres, HxW; NaN = no return.
Image<float> DepthInMetres(const SensorFrame& frame);

/// Steps of `depth_unit_m` to metres; 0 and 65535 become NaN.
Image<float> DepthInMetres(const Image<uint16_t>& depth, double depth_unit_m);

/// Metres to steps of `depth_unit_m`, rounded; 0 for NaN and for what is outside 1..65534 steps.
Image<uint16_t> DepthInSteps(const Image<float>& depth_m, double depth_unit_m);

/// "frame utime 5 of camera 3: ", for the beginning of an error.
std::string FrameText(const FrameHeader& header);

}  // namespace vismap
