#pragma once

#include <optional>

#include "datasets/detections_file.h"
#include "runtime/main.h"

namespace vismap {

/// Answers every RGBD_FRAME with one DETECTIONS, also when the source has none for it or says that
/// no detector looked at it, until stop is requested. `camera` = answer this camera only; none =
/// all.
Outcome RunRecordedDetector(const DetectionSource& source, std::optional<CameraId> camera,
                            ProcessContext& context);

}  // namespace vismap
