#pragma once

#include <vector>

#include "evaluation/ground_truth.h"
#include "meshing/mesh.h"

namespace vismap {

/// What a map says at each point of a ground truth: the ids of the nearest vertex within a radius,
/// else none. All metrics of objects are counted on these points, so that maps of any resolution
/// are measured alike.
struct TransferredLabels {
  std::vector<double> distance;  ///< to the nearest vertex [m]; infinite without any
  std::vector<SegmentLabel> segment;
  std::vector<InstanceId> instance;
  std::vector<ClassId> class_id;
};

/// Vertices that are not finite are left out; vertices equally near: the lower index.
/// `radius` [m]: 5 cm in the published evaluation of SceneNN (ALGORITHM 7.6).
TransferredLabels TransferLabels(const GroundTruth& truth, const Mesh& mesh, double radius);

}  // namespace vismap
