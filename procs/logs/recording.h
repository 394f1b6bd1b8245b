#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "config/process_options.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"

namespace vismap {

/// A sequence, and remarks on it for the user.
struct Recording {
  std::unique_ptr<Dataset> dataset;
  /// Sentences, for example why the map will differ from the recorded one.
  std::vector<std::string> remarks;
};

/// Whether this is the path of a log of LCM messages, judged by its name (run.lcmlog,
/// run.lcmlog.03) or else by the first bytes of the file.
bool IsLog(const std::string& path);

/// Opens a log, or a sequence as OpenSequence does. If the log has MAP_COMMITs, its frames are
/// those from which the newest map was built, in that order, and skipped() lists the others. If it
/// has none, or for "run.lcmlog?frames=all", they are all frames in order of arrival. A repeated
/// frame counts once. Each frame keeps its camera id. A log without RGBD_FRAMEs, and
/// "run.lcmlog?frames=foreign", is read as one of other robots' programs, see ForeignDataset; the
/// intrinsics, depth unit and camera id of `options` replace those of `adapter` there. Fails when
/// options.camera_id is set for a log of ours, and when a log has no usable frames.
/// `channel_prefix` stands before the names of our channels in the log.
Result<Recording> OpenRecording(const std::string& path, const std::string& format,
                                const DatasetOptions& options = {},
                                const AdapterOptions& adapter = {},
                                const std::string& channel_prefix = "");

/// Opens the detections in a log, or other detections as OpenDetections does. DetectorRan is false
/// for frames without a DETECTIONS message and, if the log has commits, for frames that were
/// integrated without detections because these arrived too late.
Result<std::unique_ptr<DetectionSource>> OpenRecordedDetections(
    const std::string& path, const std::string& channel_prefix = "");

}  // namespace vismap
