// Walks through a sequence and prints what it takes per frame to keep the leaves of free space
// inflated and their distances up to date, and for comparison what a full rebuild takes in the same
// run, on every 25th frame. Usage: navigation_bench [SEQUENCE [FRAMES [VOXELS_PER_LEAF [VOXEL_M]]]]
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "freespace/coarsener.h"
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

/// The times of one stage, frame by frame.
struct Stage {
  const char* name;
  std::vector<Spent> frames{}, rebuilds{};

  void Print() const {
    std::vector<double> sorted;
    for (const Spent& spent : frames) sorted.push_back(spent.wall);
    std::sort(sorted.begin(), sorted.end());
    const double first = Mean(frames, &Spent::cpu, 0, 0.1);
    const double last = Mean(frames, &Spent::cpu, 0.9, 1);
    std::printf("%-12s %7.2f %7.2f %7.2f %7.2f %13.2f %11.2f %7.2f %9.2f %12.2f\n", name,
                sorted[sorted.size() / 2], sorted[sorted.size() * 95 / 100],
                Mean(frames, &Spent::wall, 0, 1), Mean(frames, &Spent::cpu, 0, 1), first, last,
                last / first, Mean(rebuilds, &Spent::wall, 0, 1),
                Mean(rebuilds, &Spent::cpu, 0, 1));
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
    std::vector<BlockIndex> blocks;
    for (const auto& block : coarse.blocks) blocks.push_back(block.first);
    inflated.frames.push_back(Measure([&] { inflater.Update(leaves, blocks); }));
    field.frames.push_back(
        Measure([&] { changed_distances += distances.Update(leaves, blocks).size(); }));
    changed_blocks += blocks.size();
    if (field.frames.size() % kRebuildEvery == 0) Rebuild();
  }

  void Rebuild() {
    coarsened.rebuilds.push_back(Measure([&] { Coarsen(fine, coarsen); }));
    inflated.rebuilds.push_back(Measure([&] { *Inflate(leaves, {}); }));
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
  size_t changed_blocks = 0, changed_distances = 0;
  Stage coarsened{"leaves"}, inflated{"inflation"}, field{"distances"};
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

int Main(int argc, char** argv) {
  const std::string sequence = argc > 1 ? argv[1] : testing_support::BenchSequence();
  const int frames = argc > 2 ? std::atoi(argv[2]) : 150;
  const int factor = argc > 3 ? std::atoi(argv[3]) : 5;
  VoxelGridOptions grid;
  if (argc > 4) grid.voxel_size_m = std::atof(argv[4]);
  const ThreadLimit threads(2);
  Walk walk(grid.voxel_size_m, factor);
  testing_support::MakeRecordedMap(
      sequence, frames, grid,
      [&](const SemanticMap& map, const MapDelta& delta) { walk.Add(map, delta); });
  const auto count = static_cast<double>(walk.field.frames.size());
  std::printf("%s: %.0f frames, leaves of %.3g m, radius %.3g m, distances to %.3g m, 2 threads\n",
              sequence.c_str(), count, walk.leaves.cell_size(), InflateOptions{}.radius_m,
              walk.distances.limit_m());
  std::printf(
      "%zu blocks of leaves at the end; per frame %.1f changed, %.1f with other distances\n",
      walk.leaves.size(), static_cast<double>(walk.changed_blocks) / count,
      static_cast<double>(walk.changed_distances) / count);
  std::printf("%-12s %7s %7s %7s %13s %11s %7s %9s\n", "ms", "median", "p95", "mean", "first tenth",
              "last tenth", "ratio", "rebuild");
  for (const Stage* stage : {&walk.coarsened, &walk.inflated, &walk.field}) stage->Print();
  std::printf("*: of cpu, the time of both threads together\n");
  std::printf("distances take %.1f MB, %.1f bytes per leaf\n",
              static_cast<double>(walk.distances.bytes()) / 1e6,
              static_cast<double>(walk.distances.bytes()) /
                  (static_cast<double>(walk.leaves.size()) * kBlockVoxels));
  PrintRequests(walk);
  return 0;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) { return vismap::Main(argc, argv); }
