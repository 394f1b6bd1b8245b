#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "objects/objects.h"

namespace vismap {

/// The surface of one label in a mesh.
struct LabelSurface {
  std::vector<Eigen::Vector3f> points_W;  ///< vertices or a sample of them [m]; empty = not needed
  int64_t vertices = 0;                   ///< number of all vertices, also if points_W is empty
  double area = 0;                        ///< [m^2]
};
/// Indexed by label.
using LabelSurfaces = std::vector<LabelSurface>;

/// The surfaces of the labels in [0, labels) in a mesh. Each corner of a triangle gives a third of
/// the triangle's area to its label.
LabelSurfaces CollectSurfaces(const Mesh& mesh, size_t labels);

/// Corrects an estimate of the upward direction: returns the normal of the largest structure plane
/// whose normal is within 30 degrees of `up_W`, or `up_W` itself if there is no such plane or its
/// normal is within 3 degrees. Both have unit length. Without this correction, a camera that was
/// held at an angle or a world frame that is not level would tilt every box, and no plane would
/// count as floor.
Eigen::Vector3d RefineUp(const Eigen::Vector3d& up_W, const LabelSurfaces& surfaces,
                         const StructureOptions& options);

/// The objects of a map with all values that follow from the label table and from the amount of
/// surface of each label. Box, plane, spread and structure are not set. `whole_of` is from
/// JoinParts; empty = every label without instance is an object.
std::vector<ObjectSummary> ReadObjects(const LabelTable& table, const LabelSurfaces& surfaces,
                                       const ObjectOptions& options,
                                       std::span<const SegmentLabel> whole_of = {});

/// Sets the box of an object, and plane and spread of a discovered segment, from the points of its
/// surface [m] or an even sample of them. Does nothing for removed objects.
void MeasureObject(std::span<const Eigen::Vector3f> points_W, const ObjectOptions& options,
                   ObjectSummary* object);

/// Sets `structure` of all objects. They must have been measured (MeasureObject).
void SetStructure(const ObjectOptions& options, std::vector<ObjectSummary>* objects);

/// Erases the discovered segments that are not structure and too insignificant to be objects, see
/// min_discovered_frames, min_discovered_area_m2 and min_discovered_fill. Structure must have been
/// set (SetStructure). A removed object has no surface left, so only its number of frames is
/// checked.
void EraseInsignificant(const ObjectOptions& options, std::vector<ObjectSummary>* objects);

}  // namespace vismap
