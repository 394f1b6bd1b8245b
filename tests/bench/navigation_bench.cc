// Walks through a sequence and prints what it takes per frame to keep the octrees of free space
// (raw, closed and inflated) and the distances of their leaves up to date, and for comparison what
// a full rebuild takes in the same run, on every 25th frame; and what requests of planners take at
// the end. What is asked for stands beside it. Usage: navigation_bench [SEQUENCE [FRAMES
// [VOXELS_PER_LEAF [VOXEL_M]]]]
#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "freespace/block_region.h"
#include "freespace/coarsener.h"
#include "freespace/octree_cache.h"
#include "navigation/distance_field.h"
#include "navigation/frontiers.h"
#include "navigation/ground_grid.h"
#include "navigation/inflate.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

constexpr int kRebuildEvery = 25;

/// What a piece of work took [ms].
struct Spent {
  double wall = 0;
  double cpu = 0;  // of all threads
};

double CpuMilliseconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) / 1e6;
}

template <typename Work>
Spent Measure(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  const double cpu = CpuMilliseconds();
  work();
  const std::chrono::duration<double, std::milli> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), CpuMilliseconds() - cpu};
}

/// The mean of the values in a part of a list, given as shares of its length.
double Mean(const std::vector<Spent>& list, double Spent::*value, double from, double to) {
  const auto count = static_cast<double>(list.size());
  const auto first = static_cast<size_t>(from * count);
  const size_t last = std::max(static_cast<size_t>(to * count), first + 1);
  double sum = 0;
  for (size_t i = first; i < last && i < list.size(); ++i) sum += list[i].*value;
  return sum / static_cast<double>(last - first);
}

std::string Number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.1f", value);
  return text.data();
}

/// The times of one stage, frame by frame.
struct Stage {
  const char* name;
  double goal = 0;  // of the mean [ms]; 0 = none
  std::vector<Spent> frames{}, rebuilds{};

  void Print() const {
    std::vector<double> sorted;
    for (const Spent& spent : frames) sorted.push_back(spent.wall);
    std::sort(sorted.begin(), sorted.end());
    const double first = Mean(frames, &Spent::cpu, 0, 0.1);
    const double last = Mean(frames, &Spent::cpu, 0.9, 1);
    std::printf("%-12s %7.2f %7.2f %7.2f %7s %7.2f %12.2f %11.2f %7.2f %8.2f %8.2f\n", name,
                sorted[sorted.size() / 2], sorted[sorted.size() * 95 / 100],
                Mean(frames, &Spent::wall, 0, 1), goal > 0 ? Number(goal).c_str() : "-",
                Mean(frames, &Spent::cpu, 0, 1), first, last, last / first,
                Mean(rebuilds, &Spent::wall, 0, 1), Mean(rebuilds, &Spent::cpu, 0, 1));
  }
};

struct Walk {
  explicit Walk(double voxel, int factor)
      : coarsen{factor, 1.0},
        fine(voxel),
        coarsener(voxel, coarsen),
        inflater(*Inflater::Make(voxel * factor, {})),
        distances(*DistanceField::Make(voxel * factor, {})) {}

  void Add(const SemanticMap& map, const MapDelta& delta) {
    std::vector<BlockIndex> changed;
    for (const auto& block : fine.Update(map, delta.changed_blocks, {}).blocks)
      changed.push_back(block.first);
    OccupancyDelta coarse;
    coarsened.frames.push_back(Measure([&] { coarse = coarsener.Update(fine, changed); }));
    const std::vector<BlockIndex> blocks = IndicesOf(coarse);
    std::vector<BlockIndex> near;
    inflated.frames.push_back(Measure([&] { near = IndicesOf(inflater.Update(leaves, blocks)); }));
    trees.frames.push_back(Measure([&] { WriteTrees(blocks, near); }));
    all_trees.frames.push_back(Sum({&coarsened, &inflated, &trees}));
    field.frames.push_back(
        Measure([&] { changed_distances += distances.Update(leaves, blocks).size(); }));
    changed_blocks += blocks.size();
    if (field.frames.size() % kRebuildEvery == 0) Rebuild();
  }

  static std::vector<BlockIndex> IndicesOf(const OccupancyDelta& delta) {
    std::vector<BlockIndex> indices;
    for (const auto& block : delta.blocks) indices.push_back(block.first);
    return indices;
  }

  /// What the stages took for the last frame together.
  static Spent Sum(std::initializer_list<const Stage*> stages) {
    Spent sum;
    for (const Stage* stage : stages) {
      sum.wall += stage->frames.back().wall;
      sum.cpu += stage->frames.back().cpu;
    }
    return sum;
  }

  void WriteTrees(std::span<const BlockIndex> changed,
                  std::span<const BlockIndex> inflated_blocks) {
    OctreeOptions options{.resolution_m = leaves.cell_size()};
    plain_cache.Update(leaves, changed);
    tree_bytes = plain_cache.Encode(leaves, options)->bytes.size();
    options.unknown = UnknownPolicy::kOccupied;
    tree_bytes += plain_cache.Encode(leaves, options)->bytes.size();
    inflated_cache.Update(inflater.inflated(), inflated_blocks);
    tree_bytes += inflated_cache.Encode(inflater.inflated(), options)->bytes.size();
  }

  void RebuildTrees() {
    const OctreeOptions raw{.resolution_m = leaves.cell_size()};
    const OctreeOptions closed{.resolution_m = leaves.cell_size(),
                               .unknown = UnknownPolicy::kOccupied};
    OctreeCache plain, of_inflated;
    plain.Update(leaves, leaves.SortedIndices());
    of_inflated.Update(inflater.inflated(), inflater.inflated().SortedIndices());
    Require(plain.Encode(leaves, raw) && plain.Encode(leaves, closed) &&
                of_inflated.Encode(inflater.inflated(), closed),
            "trees of the whole map");
  }

  void Rebuild() {
    trees.rebuilds.push_back(Measure([&] { RebuildTrees(); }));
    coarsened.rebuilds.push_back(Measure([&] { Coarsen(fine, coarsen); }));
    inflated.rebuilds.push_back(Measure([&] { *Inflate(leaves, {}); }));
    const Spent parts[] = {trees.rebuilds.back(), coarsened.rebuilds.back(),
                           inflated.rebuilds.back()};
    all_trees.rebuilds.push_back({});
    for (const Spent& part : parts) {
      all_trees.rebuilds.back().wall += part.wall;
      all_trees.rebuilds.back().cpu += part.cpu;
    }
    field.rebuilds.push_back(Measure([&] {
      DistanceField::Make(leaves.cell_size(), {})->Update(leaves, leaves.SortedIndices());
    }));
  }

  CoarsenOptions coarsen;
  OccupancyMap fine;
  Coarsener coarsener;
  const OccupancyMap& leaves = coarsener.coarse();
  Inflater inflater;
  DistanceField distances;
  OctreeCache plain_cache, inflated_cache;
  size_t changed_blocks = 0, changed_distances = 0, tree_bytes = 0;
  Stage coarsened{"leaves"}, inflated{"inflation"}, trees{"writing"};
  Stage all_trees{"three trees", 1}, field{"distances", 3};
};

/// What is asked for now and then, at the end of the walk.
void PrintRequests(const Walk& walk) {
  const Spent grid = Measure([&] { *MakeGroundGrid(walk.fine, {}, {}); });
  size_t frontiers = 0;
  const Spent search = Measure(
      [&] { frontiers = FindFrontiers(walk.leaves, walk.inflater.inflated(), {})->size(); });
  std::printf("grid of the whole map %.1f ms (cpu %.1f), %zu frontiers %.1f ms (cpu %.1f)\n",
              grid.wall, grid.cpu, frontiers, search.wall, search.cpu);
  std::vector<Eigen::Vector3d> points;
  for (const BlockIndex& index : walk.leaves.SortedIndices()) {
    for (const double offset : {0.9, 3.3, 5.8, 7.2}) {
      const Eigen::Vector3d leaf(8 * index.x + offset, 8 * index.y + 7 - offset,
                                 8 * index.z + offset);
      points.push_back(leaf * walk.leaves.cell_size());
    }
  }
  double sum = 0;
  const Spent queries = Measure([&] {
    for (const Eigen::Vector3d& p_W : points) sum += walk.distances.From(p_W).distance_m;
  });
  const auto count = static_cast<double>(points.size());
  std::printf("distance and gradient at a point %.2f us (mean distance %.2f m)\n",
              1e3 * queries.cpu / count, sum / count);
}

/// The median of some runs.
template <typename Work>
Spent MeasureMedian(const Work& work) {
  std::vector<Spent> runs;
  for (int i = 0; i < 7; ++i) runs.push_back(Measure(work));
  std::sort(runs.begin(), runs.end(),
            [](const Spent& a, const Spent& b) { return a.wall < b.wall; });
  return runs[runs.size() / 2];
}

/// Octrees from the voxels of the map, as the map server answers requests.
void PrintTrees(const SemanticMap& map) {
  OctreeOptions options;
  options.unknown = UnknownPolicy::kOccupied;
  const Spent whole = MeasureMedian([&] {
    Require(BuildOctree(ClassifyMap(map, {}), options).has_value(), "a tree of the map");
  });
  std::printf(
      "whole map classified and encoded %.1f ms, goal 100 (cpu %.1f): %zu blocks, %zu packed\n",
      whole.wall, whole.cpu, map.voxels.size(), MeasureMemory(map.voxels).packed_blocks);
  const Eigen::Vector3d half = Eigen::Vector3d::Constant(0.5);
  options.bounds_W = Eigen::AlignedBox3d(map.last_camera_W - half, map.last_camera_W + half);
  const BlockRegion region = RegionAround(*options.bounds_W, 0.05, map.voxels.block_size());
  const Spent box = MeasureMedian([&] {
    OccupancyMap space(map.voxels.voxel_size());
    space.Update(map, BlocksIn(map.voxels.blocks(), region), {});
    Require(BuildOctree(space, options).has_value(), "a tree of the box");
  });
  std::printf("box of 1 m^3 %.2f ms, goal 10 (cpu %.2f)\n", box.wall, box.cpu);
}

int Main(int argc, char** argv) {
  const std::string sequence = argc > 1 ? argv[1] : testing_support::BenchSequence();
  const int frames = argc > 2 ? std::atoi(argv[2]) : 150;
  const int factor = argc > 3 ? std::atoi(argv[3]) : 5;
  VoxelGridOptions grid;
  if (argc > 4) grid.voxel_size_m = std::atof(argv[4]);
  const ThreadLimit threads(2);
  Walk walk(grid.voxel_size_m, factor);
  const SemanticMap map = testing_support::MakeRecordedMap(
      sequence, frames, grid,
      [&](const SemanticMap& now, const MapDelta& delta) { walk.Add(now, delta); });
  const auto count = static_cast<double>(walk.field.frames.size());
  std::printf("%s: %.0f frames, leaves of %.3g m, radius %.3g m, distances to %.3g m, 2 threads\n",
              sequence.c_str(), count, walk.leaves.cell_size(), InflateOptions{}.radius_m,
              walk.distances.limit_m());
  std::printf(
      "%zu blocks of leaves at the end; per frame %.1f changed, %.1f with other distances\n",
      walk.leaves.size(), static_cast<double>(walk.changed_blocks) / count,
      static_cast<double>(walk.changed_distances) / count);
  std::printf("%-12s %7s %7s %7s %7s %7s %12s %11s %7s %8s %8s\n", "ms", "median", "p95", "mean",
              "goal", "cpu", "first tenth*", "last tenth*", "ratio*", "rebuild", "its cpu");
  for (const Stage* stage :
       {&walk.coarsened, &walk.inflated, &walk.trees, &walk.all_trees, &walk.field})
    stage->Print();
  std::printf("*: of cpu, the time of both threads together; goal of the ratio 1.2\n");
  std::printf("the three trees have %.1f kB\n", static_cast<double>(walk.tree_bytes) / 1e3);
  std::printf("distances take %.1f MB, %.1f bytes per leaf\n",
              static_cast<double>(walk.distances.bytes()) / 1e6,
              static_cast<double>(walk.distances.bytes()) /
                  (static_cast<double>(walk.leaves.size()) * kBlockVoxels));
  PrintRequests(walk);
  PrintTrees(map);
  return 0;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) { return vismap::Main(argc, argv); }
