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
  std::vector<std::string> lost;  ///< data that the new format cannot store, one phrase each
};

/// Writes the frames of one camera as a folder in SceneNN's layout. Colour is copied byte for byte;
/// depth, poses, intrinsics, times and detections are stored without loss, so that the same map can
/// be built from the folder. `camera` selects the camera and is required if there are several. A
/// folder cannot store four things: an order of frames other than that of their times (they are
/// sorted), frame numbers that do not ascend from 1 (they are renumbered), on which frames no
/// detector ran (they count as frames without objects), and detections without a class.
/// `detections` may be nullptr. Frames that cannot be read, or have no colour, are left out. Fails
/// when none is left, on intrinsics or a depth unit that change, and, naming the file, when a file
/// cannot be written.
Result<ConvertResult> WriteFolder(const Dataset& dataset, const DetectionSource* detections,
                                  std::optional<CameraId> camera,
                                  const std::filesystem::path& folder);

/// Writes a sequence as a log: one RGBD_FRAME per frame and, if a detector ran on it, one
/// DETECTIONS after it. The time of recording is the utime of the frame. `detections` may be
/// nullptr. The channels get `channel_prefix`. Frames that cannot be read are left out. Fails when
/// none is left, and, naming the file, when the log cannot be written.
Result<ConvertResult> WriteLog(const Dataset& dataset, const DetectionSource* detections,
                               const std::filesystem::path& log,
                               const std::string& channel_prefix = "");

}  // namespace vismap
