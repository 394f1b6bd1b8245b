#pragma once

#include <filesystem>

#include "config/config.h"
#include "datasets/dataset.h"
#include "datasets/detections_file.h"
#include "log_tool/to_mcap.h"

namespace vismap {

/// A sequence to write, and its detections; nullptr = there are none.
struct SequenceToWrite {
  const Dataset& dataset;
  const DetectionSource* detections = nullptr;
  bool with_map = false;  ///< map it, as vismap-offline-mapper does, and write the map as it grows
};

/// Writes the frames and detections of a sequence as an MCAP file, and its map, if wanted: surface,
/// objects, free space and the segments of each frame. All times are those of the frames. Frames
/// that cannot be read or mapped are counted as unusable. Fails when no frame can be used, and,
/// naming the file, when it cannot be written. When `stop` is requested, it fails with
/// kMcapStopped, and there is no file.
Result<McapExport> WriteMcap(const SequenceToWrite& sequence, const VismapConfig& config,
                             const MapTopicOptions& options, const std::filesystem::path& out,
                             const StopSignal* stop = nullptr);

}  // namespace vismap
