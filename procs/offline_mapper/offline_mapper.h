#pragma once

#include <functional>
#include <memory>

#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "detection/dnn_detector.h"
#include "offline_mapper/stage_times.h"
#include "segmentation/segment_frame.h"
#include "session/map_session.h"

namespace vismap {

/// A sequence and who knows what is seen in it: somebody who remembers, or a network that looks.
/// Neither = geometry alone.
struct OfflineInput {
  const Dataset& dataset;
  const DetectionSource* detections = nullptr;
  DnnDetector* network = nullptr;  ///< goes before `detections`; frames without colour have none
};

/// Takes every frame of the sequence through segmentation, association and integration, in order:
/// what the processes do over LCM, in one process. `proceed(done)` is asked before each frame;
/// false ends early. Fails on the first frame that cannot be read.
Result<void> MapSequence(const OfflineInput& input, const SegmentationStageOptions& options,
                         const std::function<bool(size_t done)>& proceed, MapSession* session,
                         StageTimes* times);

}  // namespace vismap
