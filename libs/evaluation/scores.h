#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "freespace/occupancy_map.h"
#include "meshing/mesh.h"

namespace vismap {

// What lives in this room: how good a map is. Here against truth given as functions, for tests on
// analytic scenes; against a scanned or tessellated truth, with the metrics of benchmarks, in
// evaluation.h. The protocols are the paper's (Grinvald 2019, Sec. IV) as far as it tells them, and
// ScanNet's. No files are written here.

/// Signed distance of a point of W to the true surface [m]; positive in free space.
using TrueDistance = std::function<double(const Eigen::Vector3d&)>;

/// How far a mesh is from the true surface [m].
struct GeometryScore {
  double mean = 0;  ///< of the unsigned distances of its vertices
  double p95 = 0;
  int64_t vertices = 0;
};
GeometryScore ScoreGeometry(const Mesh& mesh, const TrueDistance& truth);

/// One true object, by the vertices of the mesh that lie on it.
struct ObjectScore {
  double iou = 0;  ///< of the best group of vertices with one instance (else one segment)
  InstanceId instance = InstanceId::kNone;  ///< of that group; kNone = a discovered segment
  ClassId class_id = ClassId::kUnknown;     ///< of that group
  int fragments = 0;                        ///< groups that hold more than a tenth of it
  int64_t vertices = 0;                     ///< that lie on it
};
/// `truth_of` = id of the true object that each vertex lies on; 0 = none. Ties go to the lower id.
std::map<uint16_t, ObjectScore> ScoreObjects(const Mesh& mesh,
                                             const std::vector<uint16_t>& truth_of);

/// Errors of free and occupied space, over the cells of an occupancy map whose centre is farther
/// than `margin` [m] from the true surface.
struct FreeSpaceScore {
  int64_t free_cells = 0, free_but_solid = 0;
  int64_t occupied_cells = 0, occupied_but_free = 0;
  double deepest_free = 0;  ///< how deep the centre of a free cell lies in a solid [m]
};
FreeSpaceScore ScoreFreeSpace(const OccupancyMap& map, const TrueDistance& truth, double margin);

}  // namespace vismap
