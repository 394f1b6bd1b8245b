#pragma once

#include <optional>

#include "datasets/detections_file.h"
#include "runtime/main.h"

namespace vismap {

/// Publishes one DETECTIONS message for every RGBD_FRAME, from recorded detections, until stop is
/// requested. A frame on which no detector ran gets the message of EncodeDetectorDidNotRun.
/// `camera` restricts it to the frames of one camera; nullopt = all cameras.
Outcome RunRecordedDetector(const DetectionSource& source, std::optional<CameraId> camera,
                            ProcessContext& context);

}  // namespace vismap
