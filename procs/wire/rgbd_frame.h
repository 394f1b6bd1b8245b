#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vismap/rgbd_frame_t.hpp>

#include "base/result.h"
#include "geometry/frame.h"

namespace vismap {

/// Encodes a sensor frame. The bus fills in seq, source and checksum later; after_utime is -1.
rgbd_frame_t Encode(const SensorFrame& frame);

/// Decodes a frame. Fails, naming the field, on a negative utime or camera_id, an implausible
/// camera, a pose that is not finite and rigid, a depth unit outside (0, 1] m, an unknown encoding,
/// depth bytes that are not an image of the stated size, and a JPEG header with another size. The
/// colour stays a JPEG; DecodeFrame decodes it.
Result<SensorFrame> Decode(const rgbd_frame_t& message);

/// Decodes and checks the header only, as above; the images are not decoded.
Result<FrameHeader> DecodeHeader(const rgbd_frame_t& message);

/// PeekFrameHeader needs at most this number of bytes from the beginning of an encoded
/// rgbd_frame_t.
inline constexpr size_t kFramePeekBytes = 1024;

/// Decodes the header from the first kFramePeekBytes of an encoded message, to scan many messages
/// fast. Checks it as DecodeHeader does, but does not verify the checksum. Fails on another type,
/// and when there are too few bytes.
Result<FrameHeader> PeekFrameHeader(std::span<const uint8_t> bytes);

}  // namespace vismap
