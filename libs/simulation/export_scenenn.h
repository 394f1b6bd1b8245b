#pragma once

#include <filesystem>
#include <string>

#include "base/result.h"
#include "simulation/synthetic_dataset.h"

namespace vismap {

/// Writes a computed sequence with its truth as SceneNN does, for tools that read files: below
/// `root` intrinsic/asus.ini, and below root/ID image/ depth/ (16-bit, mm) mask/ (16-bit, object
/// ids), timestamp.txt, trajectory.log, detections.json (COCO results), ID.ply (the surface that
/// some frame saw, 3 cm triangles with a label per vertex), ID.xml (what each label is). Read back,
/// the frames and detections are those of the computed sequence, bit for bit; frames that no
/// detector looked at have none, since COCO results cannot say so. Fails naming the file that
/// cannot be written.
Result<void> ExportSceneNn(const SyntheticOptions& options, const std::filesystem::path& root,
                           const std::string& id);

}  // namespace vismap
