#pragma once

#include <vismap/rgbd_frame_t.hpp>
#include <vismap/segmented_frame_t.hpp>

#include "base/result.h"
#include "segmentation/segmented_frame.h"

namespace vismap {

/// A segmented frame as a message. `sensor` = the message that the frame came in; it is carried
/// along unchanged instead of encoding the images again.
segmented_frame_t Encode(const SegmentedFrame& frame, const rgbd_frame_t& sensor);

/// The segmented frame in a message, images decoded. Fails as Decode(rgbd_frame_t) and DecodeFrame
/// do, and on a label image that is not of the frame's size or has other segments than listed, a
/// class outside [0, 65535], a score or overlap outside [0, 1], a pixel count that is not the label
/// image's, a detection index below -1, and a utime that is not the frame's.
Result<SegmentedFrame> Decode(const segmented_frame_t& message);

/// 32 hexadecimal digits over what the map is made from: images, camera, pose, segments with their
/// detections; not over who sent them and when.
std::string DigestInput(const segmented_frame_t& message);

}  // namespace vismap
