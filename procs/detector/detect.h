#pragma once

#include "datasets/detections_file.h"
#include "runtime/main.h"

namespace vismap {

/// Answers every RGBD_FRAME with one DETECTIONS, also when the source has none for it or says that
/// no detector looked at it, until stop is requested. `camera_id` = answer this camera only; -1 =
/// all.
Outcome Detect(const DetectionSource& source, int camera_id, ProcessContext& context);

}  // namespace vismap
