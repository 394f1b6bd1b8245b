#pragma once

#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "base/result.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// Encodes a segmented frame. `sensor` is the message in which the frame arrived; it is copied
/// unchanged, so that the images need not be encoded again.
segmented_frame_t Encode(const SegmentedFrame& frame, const rgbd_frame_t& sensor);

/// Decodes a segmented frame and its images. Fails as Decode(rgbd_frame_t) and DecodeFrame do, and
/// on a label image whose size is not that of the frame or whose segments are not the listed ones,
/// a class outside [0, 65535], a score or overlap outside [0, 1], a pixel count that differs from
/// the label image, a detection index below -1, and a utime that is not that of the frame.
Result<SegmentedFrame> Decode(const segmented_frame_t& message);

/// Digest (32 hexadecimal digits) of all data that determines the map: images, camera, pose, and
/// segments with their detections. Source and sequence number do not count.
std::string DigestInput(const segmented_frame_t& message);

}  // namespace vismap
