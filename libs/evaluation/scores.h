#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "freespace/occupancy_map.h"
#include "meshing/mesh.h"

namespace vismap {

// The room `evaluation` measures how good a map is. This file compares a map with a truth that is
// given as functions, for tests on analytic scenes. evaluation.h compares it with a scanned or
// tessellated truth and has the metrics of benchmarks: those of the paper (Grinvald 2019, Sec. IV),
// as far as it describes them, and those of ScanNet. The room writes no files.

/// Signed distance of a point of W to the true surface [m]; positive in free space.
using TrueDistance = std::function<double(const Eigen::Vector3d&)>;

/// Distances of a mesh from the true surface [m].
struct GeometryScore {
  double mean = 0;  ///< mean unsigned distance of the vertices
  double p95 = 0;   ///< 95th percentile of the unsigned distances
  int64_t vertices = 0;
};
GeometryScore ScoreGeometry(const Mesh& mesh, const TrueDistance& truth);

/// How well the mesh shows one true object, counted in the vertices that lie on it.
struct ObjectScore {
  double iou = 0;  ///< of the group (instance, or segment without one) that overlaps it most
  InstanceId instance = InstanceId::kNone;  ///< of that group; kNone = a discovered segment
  ClassId class_id = ClassId::kUnknown;     ///< of that group
  int fragments = 0;                        ///< number of groups that hold more than a tenth of it
  int64_t vertices = 0;                     ///< number of vertices that lie on it
};
/// The score of each true object, by its id. `truth_of` has the id of the true object that each
/// vertex lies on; 0 = none. Ties go to instances before segments, then to the lower id.
std::map<uint16_t, ObjectScore> ScoreObjects(const Mesh& mesh,
                                             const std::vector<uint16_t>& truth_of);

/// Errors of free and occupied cells. A cell is wrong if its centre is on the wrong side of the
/// true surface and farther than `margin` [m] from it.
struct FreeSpaceScore {
  int64_t free_cells = 0, free_but_solid = 0;
  int64_t occupied_cells = 0, occupied_but_free = 0;
  double deepest_free = 0;  ///< largest depth of a free cell's centre inside a solid [m]
};
FreeSpaceScore ScoreFreeSpace(const OccupancyMap& map, const TrueDistance& truth, double margin);

}  // namespace vismap
