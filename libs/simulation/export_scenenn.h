#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {

/// Writes a computed sequence and its ground truth as files in SceneNN's layout. Writes
/// root/intrinsic/asus.ini and, in root/ID: image/, depth/ (16-bit, mm), mask/ (16-bit, object
/// ids), timestamp.txt, trajectory.log, detections.json (COCO results), ID.ply (the surface that
/// some frame saw, in triangles of 3 cm with a label per vertex) and ID.xml (a description of each
/// label). Frames and detections read back are equal bit for bit, with one exception: frames on
/// which the detector did not run have an empty set of detections, because COCO results cannot
/// express the difference. Fails with the name of the file that cannot be written.
Result<void> ExportSceneNn(const SyntheticOptions& options, const std::filesystem::path& root,
                           const std::string& id);

}  // namespace vismap
