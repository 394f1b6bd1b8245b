#pragma once

#include <vector>

#include "evaluation/ground_truth.h"
#include "meshing/mesh.h"

namespace vismap {

/// The labels of a map at each point of a ground truth: those of the nearest vertex within a
/// radius, or none. All metrics of objects are counted on these points, so that they do not depend
/// on the resolution of the map.
struct TransferredLabels {
  std::vector<double> distance;  ///< to the nearest vertex [m]; infinite if the map is empty
  std::vector<SegmentLabel> segment;
  std::vector<InstanceId> instance;
  std::vector<ClassId> class_id;
};

/// Transfers the labels. Vertices that are not finite are left out; ties go to the lower index. The
/// published evaluation of SceneNN uses a `radius` of 5 cm [m]; see libs/METHOD.md, Evaluation.
TransferredLabels TransferLabels(const GroundTruth& truth, const Mesh& mesh, double radius);

}  // namespace vismap
