#pragma once

#include <cstddef>
#include <vismap/detections_t.hpp>

#include "base/result.h"
#include "geometry/frame.h"
#include "segmentation/detections.h"

namespace vismap {

/// More detections of one frame, or masks whose boxes cover more pixels together, are refused.
inline constexpr int kMaxDetections = 4096;
inline constexpr size_t kMaxMaskPixels = size_t{1} << 27;

/// The detections of one frame as a message. `image_width`, `image_height` [px] of the frame; every
/// mask must have this size.
detections_t Encode(const DetectionSet& set, int image_width, int image_height);

/// The message that says that no detector looked at a frame, nor will: it need not be waited for.
/// The frame then goes on without detections, which is not the same as with none found.
detections_t EncodeDetectorDidNotRun(const FrameHeader& header);
/// Whether a detector looked at the frame of this message.
bool DetectorRan(const detections_t& message);

/// The detections in a message, masks cropped to their boxes. Fails, naming the field, on a
/// negative utime or camera_id, an image size outside [1, 16384] (also when no detector looked, see
/// DetectorRan), a class outside [0, 65535], a
/// score outside [0, 1], and runs that do not fill the image exactly.
Result<DetectionSet> Decode(const detections_t& message);

}  // namespace vismap
