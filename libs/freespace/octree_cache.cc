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

/// The last cubes of the key space have no shell, so that no tree fills all of it, which OctoMap
/// cannot write [leaves].
constexpr int32_t kShellEnd = kOctreeCellOffset - kOctreeCubeSide;

/// The box and its shell. The shell ends where nodes of the size of cubes do, so that it has few.
OctreeExtent WithShell(const OccupancyBox& box, const OctreeOptions& options) {
  if (options.unknown == UnknownPolicy::kAbsent || options.shell_m <= 0) return {box, box};
  const double wanted = std::ceil(options.shell_m / options.resolution_m - 1e-6);
  const auto shell = static_cast<int32_t>(std::min<double>(wanted, 2 * kOctreeCellOffset));
  constexpr int32_t kRest = kOctreeCubeSide - 1;
  const auto low = [&](int32_t min) {
    return std::min(min, std::max(min - shell, -kShellEnd)) & ~kRest;
  };
  const auto high = [&](int32_t max) {
    return (std::max(max, std::min(max + shell, kShellEnd)) + kRest) & ~kRest;
  };
  return {box,
          {{low(box.min.x), low(box.min.y), low(box.min.z)},
           {high(box.max.x), high(box.max.y), high(box.max.z)}}};
}

/// Whether OctoMap's key space ends within the shell.
bool IsCut(const OctreeExtent& extent, const OctreeOptions& options) {
  if (extent.box == extent.outer) return false;
  const double reach = kShellEnd - options.shell_m / options.resolution_m;
  const auto [min, max] = extent.box;
  return std::min({min.x, min.y, min.z}) < -reach || std::max({max.x, max.y, max.z}) > reach;
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

bool IsEmpty(const OccupancyBox& box) {
  return box.min.x >= box.max.x || box.min.y >= box.max.y || box.min.z >= box.max.z;
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

Result<void> CheckOctreeBounds(const Eigen::AlignedBox3d& bounds_W) {
  const Eigen::Vector3d &min = bounds_W.min(), &max = bounds_W.max();
  if (min.allFinite() && max.allFinite() && (min.array() < max.array()).all()) return {};
  const auto corner = [](const Eigen::Vector3d& p) {
    return "(" + ShortestText(p.x()) + ", " + ShortestText(p.y()) + ", " + ShortestText(p.z()) +
           ")";
  };
  return Fail("octree bounds: expected finite numbers, and each minimum below its maximum; found " +
              corner(min) + " to " + corner(max) + " m");
}

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

void OctreeCache::EncodeChanged(const OccupancyMap& leaves, const OctreeExtent& extent,
                                UnknownPolicy unknown) {
  struct Task {
    const OctreeCube* place;
    OctreeExtent extent;
    Written* written;
  };
  std::vector<Task> tasks;
  for (auto& [order, cube] : cubes_) {
    // Only the known cells within the bounds matter: unknown ones are written like those outside.
    const OccupancyBox known = Intersect(cube.known, extent.box);
    const bool closed = unknown == UnknownPolicy::kOccupied;
    const OctreeExtent part{known, closed ? Intersect(cube.place.Box(), extent.outer) : known};
    Written* written = &cube.written[static_cast<size_t>(unknown)];
    if (written->extent != part) tasks.push_back({&cube.place, part, written});
  }
  ParallelFor(tasks.size(), 8, [&](size_t i) {
    const Task& task = tasks[i];
    *task.written = {task.extent, EncodeSubtree(*task.place, &leaves, task.extent, unknown)};
  });
  encoded_ = static_cast<int64_t>(tasks.size());
}

Result<OctreeBytes> OctreeCache::Encode(const OccupancyMap& leaves, const OctreeOptions& options) {
  const double resolution = options.resolution_m;
  if (!unreachable_.empty() && cubes_.empty() && !options.bounds_W)
    return Fail("octree: all of the map lies" + BeyondReach(resolution));
  const Result<std::optional<OccupancyBox>> box = BoxOf(options);
  if (!box) return tl::unexpected(box.error());
  OctreeBytes octree;
  octree.resolution = resolution;
  octree.unknown = options.unknown;
  octree.shell_m = options.unknown == UnknownPolicy::kOccupied ? options.shell_m : 0;
  const OctreeExtent extent = WithShell(box->value_or(OccupancyBox{}), options);
  const NodeWriter tree = *box ? EncodeWithin(leaves, extent, options.unknown) : NodeWriter();
  octree.nodes = tree.nodes();
  if (*box) octree.bounds_W = MetersOf(**box, resolution);
  octree.bytes = WithHeader(tree, resolution);
  octree.left_out = LeftOut(*box && IsCut(extent, options), resolution);
  return octree;
}

/// The bounds in leaves; nullopt when nothing is known and no bounds are given.
Result<std::optional<OccupancyBox>> OctreeCache::BoxOf(const OctreeOptions& options) const {
  std::optional<OccupancyBox> box = KnownCells();
  if (options.bounds_W) {
    if (const Result<void> checked = CheckOctreeBounds(*options.bounds_W); !checked)
      return tl::unexpected(checked.error());
    box = CellsOf(*options.bounds_W, options.resolution_m);
    if (IsEmpty(*box)) {
      return Fail("octree bounds: expected a box with the centre of at least one leaf of " +
                  ShortestText(options.resolution_m) + " m, within " +
                  ShortestText(kOctreeCellOffset * options.resolution_m) + " m of the origin");
    }
  }
  if (box && options.unknown == UnknownPolicy::kOccupied) {
    if (const Result<void> checked = CheckClosed(*box, options.resolution_m); !checked)
      return tl::unexpected(checked.error());
  }
  return box;
}

NodeWriter OctreeCache::EncodeWithin(const OccupancyMap& leaves, const OctreeExtent& extent,
                                     UnknownPolicy unknown) {
  EncodeChanged(leaves, extent, unknown);
  std::vector<PlacedSubtree> parts;
  parts.reserve(cubes_.size());
  for (const auto& [order, cube] : cubes_) {
    parts.push_back({order, &cube.written[static_cast<size_t>(unknown)].subtree});
  }
  return AssembleOctree(parts, extent.outer, unknown);
}

std::string OctreeCache::LeftOut(bool shell_is_cut, double resolution) const {
  std::string sentence;
  if (!unreachable_.empty()) {
    sentence = std::to_string(unreachable_.size()) +
               " pieces of the map are not in the octree: they lie" + BeyondReach(resolution);
  }
  if (shell_is_cut) {
    sentence += std::string(sentence.empty() ? "" : "; ") +
                "parts of the occupied shell around the octree are missing: they lie" +
                BeyondReach(resolution);
  }
  return sentence;
}

}  // namespace vismap
