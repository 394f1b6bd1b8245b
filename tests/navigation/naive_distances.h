#pragma once

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "freespace/occupancy_map.h"
#include "navigation/distance_kernels.h"

namespace vismap::testing_support {

// Plain twins of the kernels and of distance fields, for one leaf.

inline uint16_t NaiveLeast(const uint16_t* in, ptrdiff_t stride, int window, const uint16_t* cost,
                           uint16_t most) {
  int least = kBeyond;
  for (int d = -window; d <= window; ++d)
    least = std::min(least, in[d * stride] + cost[std::abs(d)]);
  return static_cast<uint16_t>(least > most ? kBeyond : least);
}

inline uint16_t NaiveSquare(uint8_t leaves) {
  if (leaves == kNoneInRow) return kBeyond;
  const int half_leaves = std::max(0, 2 * leaves - 1);
  return static_cast<uint16_t>(half_leaves * half_leaves);
}

inline bool NaiveAnyNear(uint16_t least, uint16_t cost, uint16_t now, uint16_t most) {
  return least + cost <= now && least + cost <= most;
}

/// The distance from the centre of a leaf to the face of the nearest leaf of a state, in half
/// leaves squared; kBeyond when it is more than `most`.
inline uint16_t NaiveFromCentre(const OccupancyMap& leaves, VoxelIndex at, CellState state,
                                int most) {
  const int reach = (static_cast<int>(std::sqrt(most)) + 1) / 2;
  const auto half_leaves2 = [](int d) {
    const int half_leaves = std::max(0, 2 * std::abs(d) - 1);
    return half_leaves * half_leaves;
  };
  int least = most + 1;
  for (int z = -reach; z <= reach; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      const int across = half_leaves2(y) + half_leaves2(z);
      if (across >= least) continue;
      for (int x = -reach; x <= reach; ++x) {
        const int distance = across + half_leaves2(x);
        if (distance >= least) continue;
        if (leaves.At(VoxelIndex{at.x + x, at.y + y, at.z + z}) == state) least = distance;
      }
    }
  }
  return static_cast<uint16_t>(least > most ? kBeyond : least);
}

/// The distance from a point to the box of the nearest leaf of a state [m], at most `limit` [m].
inline double NaiveFromPoint(const OccupancyMap& leaves, const Eigen::Vector3d& p, CellState state,
                             double limit) {
  const double leaf = leaves.cell_size();
  const int reach = static_cast<int>(std::ceil(limit / leaf)) + 1;
  const auto first = [&](int axis) { return static_cast<int>(std::floor(p[axis] / leaf)); };
  double least = limit;
  for (int z = first(2) - reach; z <= first(2) + reach; ++z) {
    for (int y = first(1) - reach; y <= first(1) + reach; ++y) {
      for (int x = first(0) - reach; x <= first(0) + reach; ++x) {
        if (leaves.At(VoxelIndex{x, y, z}) != state) continue;
        const Eigen::Vector3d low = Eigen::Vector3d(x, y, z) * leaf;
        const Eigen::AlignedBox3d box(low, low + Eigen::Vector3d::Constant(leaf));
        least = std::min(least, box.exteriorDistance(p));
      }
    }
  }
  return least;
}

}  // namespace vismap::testing_support
