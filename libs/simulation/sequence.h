#pragma once

#include <memory>
#include <string>

#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"

namespace vismap {

/// Opens a sequence: a computed one for "synthetic:room?frames=20&..." or "synthetic:office?..."
/// (see synthetic_dataset.h), otherwise a folder (see OpenDataset, also for `format`). Fails on
/// invalid parameters and on what OpenDataset fails on.
Result<std::unique_ptr<Dataset>> OpenSequence(const std::string& path, const std::string& format,
                                              const DatasetOptions& options = {});

/// Opens detections: simulated ones for "synthetic:room?..." (of the sequence with the same name),
/// otherwise a COCO results file or a folder of instance PNGs (see LoadDetections).
Result<std::unique_ptr<DetectionSource>> OpenDetections(const std::string& path);

}  // namespace vismap
