#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "objects/objects.h"

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

/// A better guess of the upward direction: the normal of the largest plane within 30 degrees of
/// `up_W`, if that is more than 3 degrees off; a camera that is held at a slant, or a world whose
/// axes are not level, would else tilt every box, and leave no floor.
Eigen::Vector3d LevelUp(const Eigen::Vector3d& up_W, const LabelSurfaces& surfaces,
                        const StructureOptions& options);

/// Which objects there are, with all that the labels and the amounts of surface tell. Box,
/// plane and structure are not set.
std::vector<ObjectSummary> ReadObjects(const LabelTable& table, const LabelSurfaces& surfaces,
                                       const ObjectOptions& options);

/// The same options with the upward direction that the surface suggests, when it is but a guess.
ObjectOptions WithLevelUp(ObjectOptions options, const LabelSurfaces& surfaces);

/// Sets box, plane and spread of an object from points of its surface [m], all or an even pick of
/// them; of one that was removed none.
void MeasureObject(std::span<const Eigen::Vector3f> points_W, const ObjectOptions& options,
                   ObjectSummary* object);

/// Sets the structure of all objects, which are measured.
void SetStructure(const ObjectOptions& options, std::vector<ObjectSummary>* objects);

/// Takes out discovered segments that are neither structure nor things, see
/// `min_discovered_frames`,
/// `_area` and `_fill`. The objects are measured and have their structure. Of what was removed no
/// surface is left to judge, only its frames count.
void LeaveOutScraps(const ObjectOptions& options, std::vector<ObjectSummary>* objects);

}  // namespace vismap
