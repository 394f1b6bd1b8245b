#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "base/ids.h"
#include "base/result.h"

namespace vismap {

/// One annotated object of a ground truth.
struct TrueObject {
  uint32_t label = 0;                    ///< label of its points; unique, not 0
  std::string name;                      ///< for display
  ClassId class_id = ClassId::kUnknown;  ///< COCO class; kUnknown = COCO does not have its class
  bool is_structure = false;             ///< floor, wall, ceiling
  int frames = std::numeric_limits<int>::max();  ///< number of frames that show it, if known
};

/// The true surface of a scene with its objects.
struct GroundTruth {
  std::string name;
  std::string format;                     ///< "scenenn", "scannet" or "synthetic"
  std::vector<Eigen::Vector3f> points_W;  ///< [m]
  std::vector<uint32_t> labels;           ///< of each point; 0 or not in `objects` = no object
  std::vector<std::array<uint32_t, 3>> triangles;  ///< indices of points; empty = only points
  std::vector<TrueObject> objects;                 ///< in the order of the annotation

  /// For each point, the index of its object in `objects`; -1 = no object.
  std::vector<int> ObjectOfPoints() const;
};

/// Reads the ground truth of a SceneNN folder: ID.ply with an integer `label` per vertex, and
/// ID.xml, which describes each label. The name of a label's class is the attribute `kind` (which
/// our exports write) or else `nyu_class`. The class is the one of the paper's nine with this name
/// (see PaperClassFromName), else `coco_id`, else the COCO class whose name is `text`. Labels
/// without a `text` are not objects, as in the published evaluation of this data set. Fails, naming
/// the file, if it is missing or malformed.
Result<GroundTruth> ReadSceneNnTruth(const std::filesystem::path& folder);

/// Reads the ground truth of a ScanNet folder: SCENE_vh_clean_2.ply, the segment of each vertex
/// (SCENE_vh_clean_2.0.010000.segs.json) and the segments of each object (SCENE.aggregation.json or
/// SCENE_vh_clean.aggregation.json). The label of object k is k + 1, as in the benchmark. The class
/// follows from the column nyu40class of scannetv2-labels.combined.tsv, which is searched in the
/// folder and up to two folders above it, or else from a built-in list. Fails, naming the file, if
/// it is missing or malformed.
Result<GroundTruth> ReadScanNetTruth(const std::filesystem::path& folder);

/// Reads the ground truth of a SceneNN or ScanNet folder, which is recognised by its files. Fails
/// if the folder has the files of neither.
Result<GroundTruth> ReadGroundTruth(const std::filesystem::path& folder);

}  // namespace vismap
