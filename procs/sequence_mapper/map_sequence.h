#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "base/reason_counts.h"
#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "detection/dnn_detector.h"
#include "geometry/saturated_depth.h"
#include "plausibility/sequence_check.h"
#include "segmentation/segment_frame.h"
#include "sequence_mapper/stage_times.h"
#include "session/map_session.h"

namespace vismap {

/// A sequence, and where its detections come from: recorded ones, or a network that runs on every
/// frame. Without either, only geometry is mapped.
struct OfflineInput {
  const Dataset& dataset;
  const DetectionSource* detections = nullptr;
  DnnDetector* network = nullptr;  ///< used instead of `detections`; needs frames with colour
  SequenceCheck* check = nullptr;  ///< sees every frame
  size_t first = 0;                ///< frames of the sequence that are passed over
  bool is_part = false;            ///< so few frames that detections may be missing in most
  /// Sees every frame with its segments before it is mapped, ...
  std::function<void(const SegmentedFrame&)> on_segmented = {};
  /// ... and what it changed, unless the map refused it.
  std::function<void(const MapDelta&)> on_mapped = {};
};

/// Detections whose score is below this in all frames name no object: a label needs more than a
/// tenth of the evidence against it, see LabelTable::min_instance_ratio.
inline constexpr float kWeakScore = 0.09F;

/// What became of the frames of a sequence and of their detections.
struct MappedSequence {
  int64_t frames = 0;           ///< mapped
  int64_t used_detections = 0;  ///< belonged to frames
  int64_t weak_detections = 0;  ///< of these; they name no object, see kWeakScore
  ReasonCounts left_out;        ///< frames that could not be read, or were refused, see MapDelta
  int64_t blocks_left_out = 0;  ///< of the map, see IntegrationOptions::max_map_mb
  DepthLosses depth_losses;     ///< of all frames that were read
  ReasonCounts without_color;   ///< frames mapped without the colour that they had
  ReasonCounts without_detections;  ///< frames mapped without the detections that they had
};

/// Maps every frame of the sequence in order (see MapFrame), as the processes do over LCM.
/// `proceed(done)` is called before each frame; when it returns false, mapping ends early. A frame
/// that cannot be read is left out. Fails when the detections of most frames cannot be read (unless
/// `is_part`), and when the network fails.
Result<MappedSequence> MapSequence(const OfflineInput& input,
                                   const SegmentationStageOptions& options,
                                   const std::function<bool(size_t done)>& proceed,
                                   MapSession* session, StageTimes* times);

}  // namespace vismap
