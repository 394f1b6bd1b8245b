#pragma once

#include <cstdint>
#include <functional>

#include "freespace/occupancy_map.h"

namespace vismap {

// The room `evaluation` measures how good a map is. This file compares a map with a truth that is
// given as functions, for tests on analytic scenes. evaluation.h compares it with a scanned or
// tessellated truth and has the metrics of benchmarks: those of the paper (Grinvald 2019, Sec. IV),
// as far as it describes them, and those of ScanNet. The room writes no files.

/// Signed distance of a point of W to the true surface [m]; positive in free space.
using TrueDistance = std::function<double(const Eigen::Vector3d&)>;

/// Errors of free and occupied cells. A cell is wrong if its centre is on the wrong side of the
/// true surface and farther than `margin` [m] from it.
struct FreeSpaceScore {
  int64_t free_cells = 0, free_but_solid = 0;
  int64_t occupied_cells = 0, occupied_but_free = 0;
  double deepest_free = 0;  ///< largest depth of a free cell's centre inside a solid [m]
};
FreeSpaceScore ScoreFreeSpace(const OccupancyMap& map, const TrueDistance& truth, double margin);

}  // namespace vismap
