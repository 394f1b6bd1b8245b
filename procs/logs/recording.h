#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"

namespace vismap {

/// A sequence, and what its user should know of it.
struct Recording {
  std::unique_ptr<Dataset> dataset;
  std::vector<std::string>
      remarks;  ///< sentences, for example why a map will not be the recorded one
};

/// Whether this names a log of LCM messages: by its name (run.lcmlog, run.lcmlog.03) or by what the
/// file begins with.
bool IsLog(const std::string& path);

/// A sequence by name, as OpenSequence takes it, or a log. Of a run that was recorded with its
/// MAP_COMMITs, the frames are those that its newest map was made of, in that order; other frames
/// are listed in skipped(). Without commits, or with "run.lcmlog?frames=all", they are all frames
/// in the order of their arrival. Repeats count once. Each frame keeps its camera. Fails when
/// options ask for a camera, and on a file that holds no frames.
Result<Recording> OpenRecording(const std::string& path, const std::string& format,
                                const DatasetOptions& options = {});

/// Detections by name, as OpenDetections takes it, or those in a log, found by camera and utime.
/// With commits, frames that were integrated without detections have none, also when they came
/// later: DetectorRanOn is false for them, and for frames without a DETECTIONS message.
Result<std::unique_ptr<DetectionSource>> OpenRecordedDetections(const std::string& path);

}  // namespace vismap
