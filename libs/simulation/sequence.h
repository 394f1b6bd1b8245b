#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"

namespace vismap {

/// Opens a sequence by name: "synthetic:room?frames=20&..." or "synthetic:office?..." (see
/// synthetic_dataset.h), else a folder as OpenDataset takes it.
Result<std::unique_ptr<Dataset>> OpenSequence(const std::string& path, const std::string& format,
                                              const DatasetOptions& options = {});

/// Opens detections by name: "synthetic:room?..." simulates those of the same synthetic sequence,
/// else a COCO results file or a folder of instance PNGs (see detections_file.h).
Result<std::unique_ptr<DetectionSource>> OpenDetections(const std::string& path);

}  // namespace vismap
