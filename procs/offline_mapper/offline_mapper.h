#pragma once

#include <functional>
#include <memory>

#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "detection/dnn_detector.h"
#include "offline_mapper/stage_times.h"
#include "plausibility/sequence_check.h"
#include "segmentation/segment_frame.h"
#include "session/map_session.h"

namespace vismap {

/// A sequence, and where its detections come from: recorded ones, or a network that runs on every
/// frame. Without either, only geometry is mapped.
struct OfflineInput {
  const Dataset& dataset;
  const DetectionSource* detections = nullptr;
  DnnDetector* network = nullptr;  ///< used instead of `detections`; needs frames with colour
  SequenceCheck* check = nullptr;  ///< sees every frame
};

/// Maps every frame of the sequence in order (see MapFrame), as the processes do over LCM.
/// `proceed(done)` is called before each frame; when it returns false, mapping ends early. Fails on
/// the first frame that cannot be read. Returns how many detections belonged to frames.
Result<int64_t> MapSequence(const OfflineInput& input, const SegmentationStageOptions& options,
                            const std::function<bool(size_t done)>& proceed, MapSession* session,
                            StageTimes* times);

}  // namespace vismap
