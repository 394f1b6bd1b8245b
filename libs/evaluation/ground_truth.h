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

/// One annotated thing of a ground truth.
struct TrueObject {
  uint32_t label = 0;                    ///< of its points; unique, not 0
  std::string name;                      ///< for people
  ClassId class_id = ClassId::kUnknown;  ///< COCO; kUnknown = a class that no COCO detector knows
  bool is_structure = false;             ///< floor, wall, ceiling
  int frames = std::numeric_limits<int>::max();  ///< of the sequence that show it, where told
};

/// A labelled surface: what a map should be.
struct GroundTruth {
  std::string name;
  std::string format;                              ///< "scenenn", "scannet" or "synthetic"
  std::vector<Eigen::Vector3f> points_W;           ///< [m]
  std::vector<uint32_t> labels;                    ///< of each point; 0 or unlisted = nobody's
  std::vector<std::array<uint32_t, 3>> triangles;  ///< of the points; empty = a cloud
  std::vector<TrueObject> objects;                 ///< as the annotation orders them

  /// Index in `objects` of each point; -1 = nobody's.
  std::vector<int> ObjectOfPoints() const;
};

/// Reads SceneNN: ID.ply with an integer `label` per vertex, ID.xml that says what each label is. A
/// label's class is its `kind` where that attribute is (our own exports), else its `nyu_class`; one
/// of the paper's nine (ALGORITHM 7.3), else `coco_id`, else the COCO class of this name. Labels
/// without a `text` are nobody's, as in the published evaluation of this data.
Result<GroundTruth> ReadSceneNnTruth(const std::filesystem::path& folder);

/// Reads ScanNet: SCENE_vh_clean_2.ply, its segments (SCENE_vh_clean_2.0.010000.segs.json) and
/// which of them make an object (SCENE.aggregation.json or SCENE_vh_clean.aggregation.json). The
/// label of object k is k + 1, as in the benchmark. Names become classes by nyu40class of
/// scannetv2-labels.combined.tsv, in the folder or up to two above it, else by a built-in list.
Result<GroundTruth> ReadScanNetTruth(const std::filesystem::path& folder);

/// Whichever of the two the folder holds; fails, saying what was looked for, when neither.
Result<GroundTruth> ReadGroundTruth(const std::filesystem::path& folder);

}  // namespace vismap
