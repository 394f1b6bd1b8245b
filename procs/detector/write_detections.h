#pragma once

#include <cstdint>
#include <string>

#include "datasets/dataset.h"
#include "detection/dnn_detector.h"
#include "runtime/main.h"

namespace vismap {

/// Runs the network on every frame of a sequence, without a bus, and writes the detections as COCO
/// results to the file `out`. Frames without colour get no detections. Fails on the first frame
/// that cannot be read, and when stop is requested before the end.
Outcome WriteDetections(const Dataset& dataset, DnnDetector* network, const std::string& out,
                        const StopSignal& stop);

}  // namespace vismap
