#pragma once

#include "geometry/frame.h"
#include "simulation/simulate.h"

namespace vismap {

/// The cameras of a RealSense-like sensor: depth of 848x480 without distortion beside colour of
/// 1280x720 with Brown-Conrady distortion, 15 mm apart and turned by 0.4 degrees.
FrameOptics RealSenseOptics();

/// The frame that this sensor measures, as it takes it (not rectified): depth in whole millimetres,
/// colour as JPEG. `header.T_W_C` is the pose of the colour camera. Colour is exact but for the
/// interpolation between pixels; the errors of depth are those of frame header.frame_number.
SensorFrame RenderRealSense(const Scene& scene, const FrameHeader& header, const DepthNoise& noise);

}  // namespace vismap
