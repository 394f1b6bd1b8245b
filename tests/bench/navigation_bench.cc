// Walks through a sequence and prints what it takes per frame to keep the leaves of free space
// inflated and their distances up to date, and for comparison what a full rebuild takes in the same
// run, on every 25th frame. Usage: navigation_bench [SEQUENCE [FRAMES [VOXELS_PER_LEAF [VOXEL_M]]]]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "freespace/coarsen.h"
#include "navigation/distance_field.h"
#include "navigation/inflate.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

constexpr int kRebuildEvery = 25;

template <typename Work>
double Milliseconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// The times of one stage, frame by frame [ms].
struct Stage {
  const char* name;
  std::vector<double> frames{}, rebuilds{};

  double Mean(double from, double to) const {
    const auto count = static_cast<double>(frames.size());
    const auto first = static_cast<ptrdiff_t>(from * count);
    const auto last = std::max(static_cast<ptrdiff_t>(to * count), first + 1);
    return std::accumulate(frames.begin() + first, frames.begin() + last, 0.0) /
           static_cast<double>(last - first);
  }
  void Print() const {
    std::vector<double> sorted = frames;
    std::sort(sorted.begin(), sorted.end());
    const double rebuild = rebuilds.empty()
                               ? 0
                               : std::accumulate(rebuilds.begin(), rebuilds.end(), 0.0) /
                                     static_cast<double>(rebuilds.size());
    std::printf("%-12s %7.2f %7.2f %7.2f %13.2f %11.2f %7.2f %9.2f\n", name,
                sorted[sorted.size() / 2], sorted[sorted.size() * 95 / 100], Mean(0, 1),
                Mean(0, 0.1), Mean(0.9, 1), Mean(0.9, 1) / Mean(0, 0.1), rebuild);
  }
};

struct Walk {
  explicit Walk(double voxel, int factor)
      : coarsen{factor, 1.0},
        fine(voxel),
        leaves(voxel * factor),
        inflater(*Inflater::Make(voxel * factor, {})),
        distances(*DistanceField::Make(voxel * factor, {})) {}

  void Add(const SemanticMap& map, const MapDelta& delta) {
    std::vector<BlockIndex> changed;
    for (const auto& block : fine.Update(map, delta.changed_blocks, {}).blocks)
      changed.push_back(block.first);
    OccupancyDelta coarse;
    coarsened.frames.push_back(
        Milliseconds([&] { coarse = UpdateCoarse(fine, changed, coarsen, &leaves); }));
    std::vector<BlockIndex> blocks;
    for (const auto& block : coarse.blocks) blocks.push_back(block.first);
    inflated.frames.push_back(Milliseconds([&] { inflater.Update(leaves, blocks); }));
    field.frames.push_back(
        Milliseconds([&] { changed_distances += distances.Update(leaves, blocks).size(); }));
    changed_blocks += blocks.size();
    if (field.frames.size() % kRebuildEvery == 0) Rebuild();
  }

  void Rebuild() {
    coarsened.rebuilds.push_back(Milliseconds([&] { Coarsen(fine, coarsen); }));
    inflated.rebuilds.push_back(Milliseconds([&] { *Inflate(leaves, {}); }));
    field.rebuilds.push_back(Milliseconds([&] {
      DistanceField::Make(leaves.cell_size(), {})->Update(leaves, leaves.SortedIndices());
    }));
  }

  CoarsenOptions coarsen;
  OccupancyMap fine, leaves;
  Inflater inflater;
  DistanceField distances;
  size_t changed_blocks = 0, changed_distances = 0;
  Stage coarsened{"leaves"}, inflated{"inflation"}, field{"distances"};
};

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
  std::printf("distances take %.1f MB, %.1f bytes per leaf\n",
              static_cast<double>(walk.distances.bytes()) / 1e6,
              static_cast<double>(walk.distances.bytes()) /
                  (static_cast<double>(walk.leaves.size()) * kBlockVoxels));
  return 0;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) { return vismap::Main(argc, argv); }
