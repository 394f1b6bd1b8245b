#pragma once

#include "datasets/detections_file.h"
#include "runtime/main.h"

namespace vismap {

/// Publishes one DETECTIONS message for every RGBD_FRAME, from recorded detections, until stop is
/// requested. A frame on which no detector ran gets the message of EncodeDetectorDidNotRun.
/// `camera_id` restricts it to the frames of one camera; -1 = all cameras.
Outcome RunRecordedDetector(const DetectionSource& source, int camera_id, ProcessContext& context);

}  // namespace vismap
