#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "datasets/dataset.h"
#include "datasets/detections_file.h"

namespace vismap {

struct ConvertResult {
  int64_t frames = 0;
  std::vector<std::string> lost;  ///< sentences: what the other form cannot hold
};

/// Writes the frames of one camera as a folder in SceneNN's layout: colour byte for byte, depth,
/// poses, intrinsics, times and detections without loss, so that the same map comes of them. Of
/// several cameras `camera` must name one. A folder cannot hold frames that are not in order of
/// time (they are put so), frame numbers that do not ascend from 1 (they are counted anew), which
/// frames no detector looked at (nothing was found in them then), and detections without a class.
/// `detections` may be null. Fails on frames without colour, on a camera that changes, and naming
/// the file that cannot be written.
Result<ConvertResult> WriteFolder(const Dataset& dataset, const DetectionSource* detections,
                                  std::optional<CameraId> camera,
                                  const std::filesystem::path& folder);

/// Writes a sequence as a log: one RGBD_FRAME per frame and, where a detector looked, one
/// DETECTIONS after it, at the frame's utime. `detections` may be null. Fails on the first frame
/// that cannot be read, and naming the file that cannot be written.
Result<ConvertResult> WriteLog(const Dataset& dataset, const DetectionSource* detections,
                               const std::filesystem::path& log);

}  // namespace vismap
