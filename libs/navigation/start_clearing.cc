#include "navigation/start_clearing.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "base/require.h"
#include "freespace/shortest_text.h"

namespace vismap {
namespace {

constexpr double kMostBodyLeaves = 100;
constexpr double kMostHeight = 10;     // [m]
constexpr double kMostOrdinate = 1e6;  // [leaves]

Result<void> CheckBody(const RobotBody& body, double leaf_m) {
  if (!(body.radius_m > 0 && body.radius_m <= kMostBodyLeaves * leaf_m)) {
    return Fail("robot body: expected a radius of more than 0 and at most " +
                ShortestText(kMostBodyLeaves * leaf_m) + " m, found " +
                ShortestText(body.radius_m) + " m");
  }
  for (const double height : {body.below_m, body.above_m}) {
    if (!(height >= 0 && height <= kMostHeight)) {
      return Fail("robot body: expected 0 to " + ShortestText(kMostHeight) +
                  " m below and above the pose, found " + ShortestText(height) + " m");
    }
  }
  return {};
}

Result<void> CheckPath(std::span<const Eigen::Vector3d> path_W, double leaf_m) {
  for (const Eigen::Vector3d& p : path_W) {
    if (p.allFinite() && p.cwiseAbs().maxCoeff() <= kMostOrdinate * leaf_m) continue;
    return Fail("path of the robot: expected finite positions within " +
                ShortestText(kMostOrdinate * leaf_m) + " m of the origin, found (" +
                ShortestText(p.x()) + ", " + ShortestText(p.y()) + ", " + ShortestText(p.z()) +
                ") m");
  }
  return {};
}

VoxelIndex LeafAt(const Eigen::Vector3d& p_W, double leaf_m) {
  const auto floor = [&](double x) { return static_cast<int32_t>(std::floor(x / leaf_m)); };
  return {floor(p_W.x()), floor(p_W.y()), floor(p_W.z())};
}

/// The leaves that a path goes through, found in steps of a quarter of a leaf.
std::set<VoxelIndex> LeavesOnPath(std::span<const Eigen::Vector3d> path_W, double leaf_m) {
  std::set<VoxelIndex> on_path;
  for (size_t i = 0; i < path_W.size(); ++i) {
    const Eigen::Vector3d& from = path_W[i > 0 ? i - 1 : 0];
    const Eigen::Vector3d way = path_W[i] - from;
    const int steps = static_cast<int>(std::ceil(way.norm() / leaf_m * 4)) + 1;
    for (int step = 0; step <= steps; ++step)
      on_path.insert(LeafAt(from + way * step / steps, leaf_m));
  }
  return on_path;
}

double GapOf(int d, double leaf_m) { return std::max(0, std::abs(d) - 1) * leaf_m; }

/// The offsets of the leaves that a body covers whose pose is in a leaf.
std::vector<VoxelIndex> CoveredOffsets(const RobotBody& body, double leaf_m) {
  const bool sphere = body.below_m == 0 && body.above_m == 0;
  const double below = sphere ? body.radius_m : body.below_m;
  const double above = sphere ? body.radius_m : body.above_m;
  constexpr double kRounding = 1e-9;
  const int reach = static_cast<int>(std::ceil(body.radius_m / leaf_m)) + 1;
  const int down = static_cast<int>(std::ceil(below / leaf_m)) + 1;
  const int up = static_cast<int>(std::ceil(above / leaf_m)) + 1;
  std::vector<VoxelIndex> offsets;
  for (int z = -down; z <= up; ++z) {
    const double along = GapOf(z, leaf_m);
    if (!sphere && z != 0 && along >= (z < 0 ? below : above) - kRounding) continue;
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const double across = std::hypot(GapOf(x, leaf_m), GapOf(y, leaf_m));
        if (std::hypot(across, sphere ? along : 0) < body.radius_m - kRounding)
          offsets.push_back({x, y, z});
      }
    }
  }
  return offsets;
}

}  // namespace

Result<LeafSets> CoveredUnknownLeaves(const OccupancyMap& leaves, const RobotBody& body,
                                      std::span<const Eigen::Vector3d> path_W) {
  const double leaf_m = leaves.cell_size();
  if (const Result<void> checked = CheckBody(body, leaf_m); !checked)
    return tl::unexpected(checked.error());
  if (const Result<void> checked = CheckPath(path_W, leaf_m); !checked)
    return tl::unexpected(checked.error());
  LeafSets sets;
  const std::vector<VoxelIndex> offsets = CoveredOffsets(body, leaf_m);
  for (const VoxelIndex& at : LeavesOnPath(path_W, leaf_m)) {
    for (const VoxelIndex& offset : offsets) {
      const VoxelIndex leaf{at.x + offset.x, at.y + offset.y, at.z + offset.z};
      if (leaves.At(leaf) != CellState::kUnknown) continue;
      const auto bit = static_cast<size_t>(OffsetInBlock(leaf));
      sets[BlockOf(leaf)][bit / 64] |= uint64_t{1} << (bit % 64);
    }
  }
  return sets;
}

BlockOccupancy WithFreeLeaves(const BlockOccupancy& block, const VoxelBits& free) {
  OccupancyPlanes planes = block.Planes();
  for (size_t i = 0; i < free.size(); ++i) {
    Require((planes.occupied[i] & free[i]) == 0, "what was seen occupied is never assumed free");
    planes.free[i] |= free[i];
  }
  return BlockOccupancy(planes);
}

}  // namespace vismap
