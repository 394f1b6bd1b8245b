#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "meshing/objects.h"

namespace vismap {

/// The surface where a label reads out.
struct LabelSurface {
  std::vector<Eigen::Vector3f> points_W;  ///< vertices [m]; none where nobody asks for boxes
  int64_t vertices = 0;                   ///< how many there are
  double area = 0;                        ///< [m^2]
};
/// Indexed by label.
using LabelSurfaces = std::vector<LabelSurface>;

/// The surface of the labels below `labels` in a mesh.
LabelSurfaces CollectSurfaces(const Mesh& mesh, size_t labels);

/// Which objects there are, with all that the labels and the amounts of surface tell. Box and
/// structure are not set.
std::vector<ObjectSummary> ReadObjects(const LabelTable& table, const LabelSurfaces& surfaces,
                                       const ObjectOptions& options);

/// Sets box and structure of an object from points of its surface [m], all or an even pick of
/// them; of one that was removed neither.
void MeasureObject(std::span<const Eigen::Vector3f> points_W, const ObjectOptions& options,
                   ObjectSummary* object);

}  // namespace vismap
