#include "freespace/octree_cache.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/require.h"
#include "freespace/octree_assembler.h"
#include "freespace/shortest_text.h"

namespace vismap {
namespace {

bool Reachable(BlockIndex block) {
  const auto fits = [](int32_t i) { return i >= -kOctreeBlockOffset && i < kOctreeBlockOffset; };
  return fits(block.x) && fits(block.y) && fits(block.z);
}

/// The cube that a block lies in.
OctreeCube CubeAround(BlockIndex block) {
  const auto first = [](int32_t i) { return kBlockSide * i & ~(kOctreeCubeSide - 1); };
  return {{first(block.x), first(block.y), first(block.z)}, kOctreeCubeSide};
}

std::optional<OccupancyBox> KnownIn(const OctreeCube& cube, const OccupancyMap& leaves) {
  std::optional<OccupancyBox> known;
  constexpr int kBlocks = kOctreeCubeSide / kBlockSide;
  const BlockIndex first = BlockOf(cube.min);
  for (int i = 0; i < kBlocks * kBlocks * kBlocks; ++i) {
    const BlockIndex index{first.x + i % kBlocks, first.y + i / kBlocks % kBlocks,
                           first.z + i / (kBlocks * kBlocks)};
    const BlockOccupancy& block = leaves.At(index);
    if (!block.is(CellState::kUnknown)) Extend(KnownCellsOf(index, block), &known);
  }
  return known;
}

/// The cells whose centres lie in the box.
OccupancyBox CellsOf(const Eigen::AlignedBox3d& bounds_W, double resolution) {
  const auto cell = [&](double at) {
    const double rounded = std::round(at / resolution);
    constexpr double kReach = kOctreeCellOffset;
    return static_cast<int32_t>(std::clamp(rounded, -kReach, kReach));
  };
  const Eigen::Vector3d& min = bounds_W.min();
  const Eigen::Vector3d& max = bounds_W.max();
  return {{cell(min.x()), cell(min.y()), cell(min.z())},
          {cell(max.x()), cell(max.y()), cell(max.z())}};
}

Result<void> CheckBounds(const Eigen::AlignedBox3d& bounds_W) {
  if (bounds_W.min().allFinite() && bounds_W.max().allFinite() && !bounds_W.isEmpty()) return {};
  return Fail("octree bounds: expected finite numbers, and no minimum above its maximum");
}

// A closed tree has nodes for all cells along the sides of its box, also where the map has nothing.
Result<void> CheckClosed(const OccupancyBox& box, double resolution) {
  constexpr double kMostCells = 1 << 26;  // 400 m x 400 m with leaves of 5 cm
  const double x = box.max.x - box.min.x, y = box.max.y - box.min.y, z = box.max.z - box.min.z;
  if (2 * (x * y + y * z + z * x) <= kMostCells) return {};
  return Fail(
      "octree: the box of " + ShortestText(x * resolution) + " m x " +
      ShortestText(y * resolution) + " m x " + ShortestText(z * resolution) +
      " m is too large to write unknown space as occupied; expected a smaller box or larger "
      "leaves (octree.resolution_m)");
}

Eigen::AlignedBox3d MetersOf(const OccupancyBox& box, double resolution) {
  return {Eigen::Vector3d(box.min.x, box.min.y, box.min.z) * resolution,
          Eigen::Vector3d(box.max.x, box.max.y, box.max.z) * resolution};
}

std::string BeyondReach(double resolution) {
  return " beyond the " + ShortestText(kOctreeCellOffset * resolution) +
         " m around the origin that an octree with leaves of " + ShortestText(resolution) +
         " m can hold; if poses are right, use larger leaves (octree.resolution_m)";
}

std::vector<uint8_t> WithHeader(const NodeWriter& tree, double resolution) {
  const std::string header =
      "# Octomap OcTree binary file\n"
      "# (feel free to add / change comments, but leave the first line as it is!)\n"
      "#\n"
      "id OcTree\nsize " +
      std::to_string(tree.nodes()) + "\nres " + ShortestText(resolution) + "\ndata\n";
  std::vector<uint8_t> bytes;
  bytes.reserve(header.size() + tree.bytes().size());
  bytes.assign(header.begin(), header.end());
  bytes.insert(bytes.end(), tree.bytes().begin(), tree.bytes().end());
  return bytes;
}

}  // namespace

void OctreeCache::Update(const OccupancyMap& leaves, std::span<const BlockIndex> changed) {
  std::map<uint64_t, OctreeCube> touched;
  for (const BlockIndex& block : changed) {
    if (Reachable(block)) {
      const OctreeCube cube = CubeAround(block);
      touched.emplace(OctreeOrder(cube), cube);
    } else if (leaves.At(block).is(CellState::kUnknown)) {
      unreachable_.erase(block);
    } else {
      unreachable_.insert(block);
    }
  }
  for (const auto& [order, cube] : touched) {
    const std::optional<OccupancyBox> known = KnownIn(cube, leaves);
    if (known) {
      cubes_[order] = Cube{cube, *known, {}};
    } else {
      cubes_.erase(order);
    }
  }
}

std::optional<OccupancyBox> OctreeCache::KnownCells() const {
  std::optional<OccupancyBox> box;
  for (const auto& entry : cubes_) Extend(entry.second.known, &box);
  return box;
}

void OctreeCache::EncodeChanged(const OccupancyMap& leaves, const OccupancyBox& box,
                                UnknownPolicy unknown) {
  struct Task {
    const OctreeCube* place;
    OccupancyBox box;
    Written* written;
  };
  std::vector<Task> tasks;
  for (auto& [order, cube] : cubes_) {
    // If unknown space gets no nodes, only the known cells within the bounds matter.
    const bool closed = unknown == UnknownPolicy::kOccupied;
    const OccupancyBox part = Intersect(closed ? cube.place.Box() : cube.known, box);
    Written* written = &cube.written[static_cast<size_t>(unknown)];
    if (written->box != part) tasks.push_back({&cube.place, part, written});
  }
  ParallelFor(tasks.size(), 8, [&](size_t i) {
    const Task& task = tasks[i];
    *task.written = {task.box, EncodeSubtree(*task.place, &leaves, task.box, unknown)};
  });
  encoded_ = static_cast<int64_t>(tasks.size());
}

Result<OctreeBytes> OctreeCache::Encode(const OccupancyMap& leaves, double resolution,
                                        UnknownPolicy unknown,
                                        const std::optional<Eigen::AlignedBox3d>& bounds_W) {
  if (!unreachable_.empty() && cubes_.empty())
    return Fail("octree: all of the map lies" + BeyondReach(resolution));
  if (bounds_W) {
    if (const Result<void> checked = CheckBounds(*bounds_W); !checked)
      return tl::unexpected(checked.error());
  }
  const std::optional<OccupancyBox> box = bounds_W ? CellsOf(*bounds_W, resolution) : KnownCells();
  if (box && unknown == UnknownPolicy::kOccupied) {
    if (const Result<void> checked = CheckClosed(*box, resolution); !checked)
      return tl::unexpected(checked.error());
  }
  EncodeChanged(leaves, box.value_or(OccupancyBox{}), unknown);
  std::vector<PlacedSubtree> parts;
  parts.reserve(cubes_.size());
  for (const auto& [order, cube] : cubes_) {
    parts.push_back({order, &cube.written[static_cast<size_t>(unknown)].subtree});
  }
  const NodeWriter tree = AssembleOctree(parts, box.value_or(OccupancyBox{}), unknown);
  OctreeBytes octree;
  octree.resolution = resolution;
  octree.nodes = tree.nodes();
  octree.unknown = unknown;
  if (box) octree.bounds_W = MetersOf(*box, resolution);
  octree.bytes = WithHeader(tree, resolution);
  if (!unreachable_.empty()) {
    octree.left_out = std::to_string(unreachable_.size()) +
                      " pieces of the map are not in the octree: they lie" +
                      BeyondReach(resolution);
  }
  return octree;
}

}  // namespace vismap
