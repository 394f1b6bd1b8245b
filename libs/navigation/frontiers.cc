#include "navigation/frontiers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "base/option_check.h"
#include "base/parallel.h"
#include "base/require.h"

namespace vismap {
namespace {

constexpr int kViewSample = 16;       // leaves of a cluster that a viewpoint should see
constexpr int kMostCandidates = 400;  // viewpoints that are looked from, the best distances first

constexpr uint64_t kRowsX0 = 0x0101010101010101ull;  // the leaves of a layer with x = 0

/// A layer of 8 x 8 leaves moved by one along x or y; what comes in from the next block is `in`.
uint64_t FromLowerX(uint64_t layer, uint64_t in) {
  return ((layer & ~(kRowsX0 << 7)) << 1) | ((in >> 7) & kRowsX0);
}
uint64_t FromUpperX(uint64_t layer, uint64_t in) {
  return ((layer & ~kRowsX0) >> 1) | ((in & kRowsX0) << 7);
}
uint64_t FromLowerY(uint64_t layer, uint64_t in) { return layer << 8 | in >> 56; }
uint64_t FromUpperY(uint64_t layer, uint64_t in) { return layer >> 8 | in << 56; }

VoxelBits UnknownLeaves(const BlockOccupancy& block) {
  const OccupancyPlanes planes = block.Planes();
  VoxelBits unknown;
  for (size_t i = 0; i < unknown.size(); ++i) unknown[i] = ~(planes.free[i] | planes.occupied[i]);
  return unknown;
}

/// The free leaves of a block with an unknown one at a face.
VoxelBits FrontierIn(const OccupancyMap& leaves, BlockIndex at) {
  const auto unknown = [&](int dx, int dy, int dz) {
    return UnknownLeaves(leaves.At(BlockIndex{at.x + dx, at.y + dy, at.z + dz}));
  };
  const VoxelBits here = unknown(0, 0, 0);
  const VoxelBits left = unknown(-1, 0, 0), right = unknown(1, 0, 0);
  const VoxelBits front = unknown(0, -1, 0), back = unknown(0, 1, 0);
  const uint64_t below = unknown(0, 0, -1)[7], above = unknown(0, 0, 1)[0];
  VoxelBits frontier = leaves.At(at).Planes().free;
  for (size_t z = 0; z < frontier.size(); ++z) {
    frontier[z] &= FromLowerX(here[z], left[z]) | FromUpperX(here[z], right[z]) |
                   FromLowerY(here[z], front[z]) | FromUpperY(here[z], back[z]) |
                   (z > 0 ? here[z - 1] : below) | (z < 7 ? here[z + 1] : above);
  }
  return frontier;
}

std::vector<VoxelIndex> AllFrontierLeaves(const OccupancyMap& leaves) {
  const std::vector<BlockIndex> blocks = leaves.SortedIndices();
  std::vector<VoxelBits> found(blocks.size());
  ParallelFor(blocks.size(), 32, [&](size_t i) {
    if (!leaves.At(blocks[i]).is(CellState::kOccupied)) found[i] = FrontierIn(leaves, blocks[i]);
  });
  std::vector<VoxelIndex> all;
  for (size_t i = 0; i < blocks.size(); ++i) {
    const BlockIndex& at = blocks[i];
    for (int z = 0; z < kBlockSide; ++z) {
      for (uint64_t left = found[i][static_cast<size_t>(z)]; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        all.push_back({8 * at.x + bit % 8, 8 * at.y + bit / 8, 8 * at.z + z});
      }
    }
  }
  return all;
}

/// The leaves of each cube of `side` leaves, as connected pieces: leaves that touch, also at an
/// edge or a corner.
std::vector<std::vector<VoxelIndex>> Clusters(const std::vector<VoxelIndex>& all, int side) {
  const auto cube = [&](int32_t i) {
    return static_cast<int32_t>(std::floor(static_cast<double>(i) / side));
  };
  std::map<VoxelIndex, std::set<VoxelIndex>> cubes;
  for (const VoxelIndex& leaf : all) cubes[{cube(leaf.x), cube(leaf.y), cube(leaf.z)}].insert(leaf);
  std::vector<std::vector<VoxelIndex>> clusters;
  for (auto& [place, left] : cubes) {
    while (!left.empty()) {
      std::vector<VoxelIndex> cluster = {*left.begin()};
      left.erase(left.begin());
      for (size_t next = 0; next < cluster.size(); ++next) {
        for (int i = 0; i < 27; ++i) {
          const VoxelIndex& at = cluster[next];
          const auto beside = left.find({at.x + i % 3 - 1, at.y + i / 3 % 3 - 1, at.z + i / 9 - 1});
          if (beside == left.end()) continue;
          cluster.push_back(*beside);
          left.erase(beside);
        }
      }
      std::sort(cluster.begin(), cluster.end());
      clusters.push_back(std::move(cluster));
    }
  }
  return clusters;
}

Eigen::Vector3d CentreOf(VoxelIndex leaf) { return {leaf.x + 0.5, leaf.y + 0.5, leaf.z + 0.5}; }

using LeafReader = BlockTable<BlockOccupancy>::Reader;

bool IsFree(LeafReader* leaves, VoxelIndex leaf) {
  const BlockOccupancy* block = leaves->Find(BlockOf(leaf));
  return block != nullptr && block->At(OffsetInBlock(leaf)) == CellState::kFree;
}

/// Whether the straight way between the centres of two leaves leads through free leaves only. Both
/// ends are looked at, too.
bool SeesThroughFree(LeafReader* leaves, VoxelIndex from, VoxelIndex to) {
  const Eigen::Vector3d start = CentreOf(from), way = CentreOf(to) - start;
  const std::array<int32_t, 3> ends = {to.x, to.y, to.z};
  std::array<int32_t, 3> at = {from.x, from.y, from.z};
  std::array<double, 3> next{}, step{};  // parts of the way to the next face along each axis
  for (size_t axis = 0; axis < 3; ++axis) {
    const double length = std::abs(way[static_cast<Eigen::Index>(axis)]);
    step[axis] = length > 0 ? 1 / length : std::numeric_limits<double>::infinity();
    next[axis] = length > 0 ? 0.5 / length : std::numeric_limits<double>::infinity();
  }
  for (;;) {
    if (!IsFree(leaves, {at[0], at[1], at[2]})) return false;
    if (at == ends) return true;
    const size_t axis =
        static_cast<size_t>(std::min_element(next.begin(), next.end()) - next.begin());
    if (next[axis] > 1) return true;
    at[axis] += way[static_cast<Eigen::Index>(axis)] > 0 ? 1 : -1;
    next[axis] += step[axis];
  }
}

/// Offsets of leaves within the distances of the options, those nearest to the best one first.
std::vector<VoxelIndex> ViewOffsets(const FrontierOptions& options, double leaf_m) {
  struct Offset {
    double worse;
    VoxelIndex at;
  };
  std::vector<Offset> offsets;
  const int reach = static_cast<int>(options.max_view_m / leaf_m);
  const int stride = std::max(1, reach / 16);  // not all of them: neighbours see the same
  for (int z = -reach; z <= reach; z += stride) {
    for (int y = -reach; y <= reach; y += stride) {
      for (int x = -reach; x <= reach; x += stride) {
        const double distance = Eigen::Vector3d(x, y, z).norm() * leaf_m;
        if (distance < options.min_view_m || distance > options.max_view_m) continue;
        offsets.push_back({std::abs(distance - options.best_view_m), {x, y, z}});
      }
    }
  }
  std::sort(offsets.begin(), offsets.end(), [](const Offset& a, const Offset& b) {
    return a.worse != b.worse ? a.worse < b.worse : a.at < b.at;
  });
  std::vector<VoxelIndex> result;
  for (const Offset& offset : offsets) result.push_back(offset.at);
  return result;
}

/// Finds viewpoints.
struct Viewer {
  const OccupancyMap& leaves;
  const OccupancyMap& inflated;
  std::vector<VoxelIndex> offsets;

  static bool Sees(LeafReader* reader, VoxelIndex from, const std::vector<VoxelIndex>& cluster) {
    const size_t sample = std::min<size_t>(kViewSample, cluster.size());
    size_t seen = 0;
    for (size_t i = 0; i < sample; ++i) {
      seen += SeesThroughFree(reader, from, cluster[i * cluster.size() / sample]);
      if (2 * seen >= sample) return true;
      if (2 * (seen + sample - i - 1) < sample) return false;  // the others cannot make up for it
    }
    return false;
  }

  std::optional<VoxelIndex> Find(VoxelIndex member, const std::vector<VoxelIndex>& cluster) const {
    LeafReader reader(leaves.blocks()), inflated_reader(inflated.blocks());
    int looked = 0;
    for (const VoxelIndex& offset : offsets) {
      const VoxelIndex from{member.x + offset.x, member.y + offset.y, member.z + offset.z};
      if (!IsFree(&inflated_reader, from)) continue;
      if (Sees(&reader, from, cluster)) return from;
      if (++looked == kMostCandidates) break;
    }
    return std::nullopt;
  }
};

Frontier MakeFrontier(std::vector<VoxelIndex> cluster, const Viewer& viewer) {
  const double leaf_m = viewer.leaves.cell_size();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const VoxelIndex& leaf : cluster) sum += CentreOf(leaf);
  const Eigen::Vector3d mean = sum / static_cast<double>(cluster.size());
  const VoxelIndex member =
      *std::min_element(cluster.begin(), cluster.end(), [&](VoxelIndex a, VoxelIndex b) {
        return (CentreOf(a) - mean).squaredNorm() < (CentreOf(b) - mean).squaredNorm();
      });
  Frontier frontier;
  frontier.center_W = mean * leaf_m;
  frontier.member_W = CentreOf(member) * leaf_m;
  if (const auto from = viewer.Find(member, cluster))
    frontier.viewpoint_W = CentreOf(*from) * leaf_m;
  frontier.leaves = std::move(cluster);
  return frontier;
}

Result<void> CheckOptions(const FrontierOptions& options, double leaf_m) {
  OptionCheck check;
  check.Range("cluster_m", options.cluster_m, leaf_m, 100);
  check.AtLeast("min_leaves", options.min_leaves, 1);
  check.Range("min_view_m", options.min_view_m, 0, 10);
  check.Range("best_view_m", options.best_view_m, options.min_view_m, 10);
  check.Range("max_view_m", options.max_view_m, options.best_view_m, 10);
  const std::vector<std::string> problems = std::move(check).problems();
  if (!problems.empty()) return Fail("frontiers: " + problems.front());
  return {};
}

}  // namespace

Result<std::vector<Frontier>> FindFrontiers(const OccupancyMap& leaves,
                                            const OccupancyMap& inflated,
                                            const FrontierOptions& options) {
  const double leaf_m = leaves.cell_size();
  Require(inflated.cell_size() == leaf_m, "frontiers are found in maps of the same leaves");
  if (const auto checked = CheckOptions(options, leaf_m); !checked)
    return tl::unexpected(checked.error());
  const int side = std::max(1, static_cast<int>(std::lround(options.cluster_m / leaf_m)));
  std::vector<std::vector<VoxelIndex>> clusters = Clusters(AllFrontierLeaves(leaves), side);
  std::erase_if(clusters, [&](const auto& cluster) {
    return static_cast<int>(cluster.size()) < options.min_leaves;
  });
  std::sort(clusters.begin(), clusters.end(), [](const auto& a, const auto& b) {
    return a.size() != b.size() ? a.size() > b.size() : a.front() < b.front();
  });
  const Viewer viewer{leaves, inflated, ViewOffsets(options, leaf_m)};
  std::vector<Frontier> frontiers(clusters.size());
  ParallelFor(clusters.size(), 1,
              [&](size_t i) { frontiers[i] = MakeFrontier(std::move(clusters[i]), viewer); });
  return frontiers;
}

}  // namespace vismap
