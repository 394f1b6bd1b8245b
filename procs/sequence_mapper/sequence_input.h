#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "config/config.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "detection/dnn_detector.h"

namespace vismap {

/// What looks for objects in the frames of a sequence; without either of them, only geometry is
/// mapped.
struct SequenceDetector {
  std::unique_ptr<DetectionSource> recorded;
  std::unique_ptr<DnnDetector> network;
};

/// Opens `detections` (COCO results, a folder of instance PNGs or a log), or none at all for
/// "none". If it is "", takes the network of the config, unless that says `recorded`, else the
/// detections that belong to the sequence, if there are any. `network_first`: the network of the
/// config is taken in any case. Fails when what was asked for cannot be read.
Result<SequenceDetector> OpenSequenceDetector(const std::string& detections, bool network_first,
                                              const VismapConfig& config, const Dataset& dataset);

}  // namespace vismap
