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

/// Decodes a frame. Fails, naming the field, on a negative utime or camera_id, impossible cameras
/// (see SetOptics), a pose that is not finite and rigid, a depth unit outside (0, 1] m, an unknown
/// encoding, depth bytes that are not an image of the depth camera's size, and colour that states
/// another size than the colour camera's. Colour stays encoded; DecodeFrame decodes it.
Result<SensorFrame> Decode(const rgbd_frame_t& message);

/// Decodes and checks the header only, as above; the images are not decoded. Its camera is that of
/// the rectified frame.
Result<FrameHeader> DecodeHeader(const rgbd_frame_t& message);

/// Decodes and checks a frame without its depth image, as above, for readers of colour alone.
Result<SensorFrame> DecodeWithoutDepth(const rgbd_frame_t& message);

/// The camera of a frame that needs no rectification.
const camera_t& CameraOf(const rgbd_frame_t& message);

/// PeekFrameHeader needs at most this number of bytes from the beginning of an encoded
/// rgbd_frame_t.
inline constexpr size_t kFramePeekBytes = 1024;

/// Decodes the header from the first kFramePeekBytes of an encoded message of `total_bytes`, to
/// scan many messages fast; also of an older version. Checks it as DecodeHeader does, but does not
/// verify the checksum. Fails on another type, and when there are too few bytes.
Result<FrameHeader> PeekFrameHeader(std::span<const uint8_t> bytes, size_t total_bytes);

}  // namespace vismap
