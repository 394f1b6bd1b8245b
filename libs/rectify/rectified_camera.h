#pragma once

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// The longest distance between depth and colour camera [m].
inline constexpr double kMaxBaseline = 1;
/// The most pixels of a depth image that has to be rectified, and of the result.
inline constexpr size_t kMaxRectifiedPixels = size_t{1} << 22;

/// Fails, naming the field of rgbd_frame_t, unless the cameras that a frame uses are possible (see
/// CheckLens, but not CheckOneToOne) and T_color_depth is finite, rigid and at most kMaxBaseline
/// long. `has_color`: whether the frame has a colour image.
Result<void> CheckOptics(const FrameOptics& optics, bool has_color);

/// Whether a frame of these cameras can be used as it is: without distortion, and with depth at the
/// pixels of the colour image.
bool IsIdeal(const FrameOptics& optics, bool has_color);

/// The camera that a frame has after it was rectified. Its viewpoint is that of the colour camera
/// (of the depth camera, without colour), and it has no distortion.
///
/// - Depth registered to colour, or no colour: size and intrinsics of that camera.
/// - Else the view of the colour camera with so many pixels that depth has about one each: the
///   image of the colour camera scaled by the larger one of the ratios of focal lengths, depth to
///   colour, and never enlarged. More pixels would only repeat depth, and cost time in all later
///   stages; fewer would lose some. Depth outside the colour image is not used.
///
/// `optics` must have passed CheckOptics.
PinholeCamera RectifiedCamera(const FrameOptics& optics, bool has_color);

/// Sets the cameras of a frame: header.camera, and `optics` unless the frame is ideal. Fails as
/// CheckOptics does, and when depth or the result would have more than kMaxRectifiedPixels.
Result<void> SetOptics(const FrameOptics& optics, bool has_color, SensorFrame* frame);

}  // namespace vismap
