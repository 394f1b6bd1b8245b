#pragma once

#include <cstddef>
#include <vismap/detections_t.hpp>

#include "base/result.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// Limits of one message: number of detections, and sum of the pixels of all mask boxes. Decode
/// rejects a message that exceeds one of them.
inline constexpr int kMaxDetections = 4096;
inline constexpr size_t kMaxMaskPixels = size_t{1} << 27;

/// Encodes the detections of one frame. `image_width` and `image_height` [px] are those of the
/// frame; every mask must have this size.
detections_t Encode(const DetectionSet& set, int image_width, int image_height);

/// A message for a frame on which no detector has run or will run, so that no process waits for its
/// detections. It is not the same as a message with zero detections, which says that a detector ran
/// and found nothing.
detections_t EncodeDetectorDidNotRun(const FrameHeader& header);
/// Whether a detector ran on the frame of this message; false for what EncodeDetectorDidNotRun
/// made.
bool DetectorRan(const detections_t& message);

/// Decodes detections and crops each mask to its box. Fails, naming the field, on a negative utime
/// or camera_id, an image size outside [1, 16384], a class outside [0, 65535], a score outside [0,
/// 1], and runs that do not add up to the image size. Fails, too, when DetectorRan is false.
Result<DetectionSet> Decode(const detections_t& message);

}  // namespace vismap
