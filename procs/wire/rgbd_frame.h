#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vismap/rgbd_frame_t.hpp>

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// A sensor's frame as a message; seq, source and checksum are left for the bus to fill,
/// after_utime is -1.
rgbd_frame_t Encode(const SensorFrame& frame);

/// The frame in a message. Fails, naming the field, on a negative utime or camera_id, an
/// implausible camera, a pose that is not finite and rigid, a depth unit outside (0, 1] m, an
/// unknown encoding, depth bytes that are not an image of the stated size, and a JPEG header of
/// another size. The JPEG's pixels are not looked at: DecodeFrame does that.
Result<SensorFrame> Decode(const rgbd_frame_t& message);

/// The header alone, checked as above, without decoding the images.
Result<FrameHeader> DecodeHeader(const rgbd_frame_t& message);

/// Bytes at the beginning of an encoded rgbd_frame_t that PeekFrameHeader looks at, at most.
inline constexpr size_t kFramePeekBytes = 1024;

/// The header alone from the first bytes (kFramePeekBytes are enough) of an encoded message, for
/// going through many fast; checked as DecodeHeader does. The checksum is not looked at. Fails on
/// another type, and on bytes cut short.
Result<FrameHeader> PeekFrameHeader(std::span<const uint8_t> bytes);

}  // namespace vismap
