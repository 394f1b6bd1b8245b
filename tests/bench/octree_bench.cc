// Free space and octrees of a recorded map. Run alone: vismap's part must be small beside a frame.
#include <benchmark/benchmark.h>

#include "freespace/coarsen.h"
#include "freespace/occupancy_codec.h"
#include "freespace/occupancy_map.h"
#include "freespace/octree.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

/// A map and the last frames' changes, made once for all benchmarks.
struct Recorded {
  SemanticMap map;
  std::vector<std::vector<BlockIndex>> changes;

  static const Recorded& Get() {
    static const Recorded recorded = [] {
      std::vector<std::vector<BlockIndex>> changes;
      SemanticMap map = testing_support::MakeRecordedMap(
          testing_support::BenchSequence(), 60, {}, [&](const SemanticMap&, const MapDelta& delta) {
            changes.push_back(delta.changed_blocks);
          });
      return Recorded{std::move(map), std::move(changes)};
    }();
    return recorded;
  }
};

void BM_ClassifyWholeMap(benchmark::State& state) {
  const SemanticMap& map = Recorded::Get().map;
  for (auto _ : state) benchmark::DoNotOptimize(ClassifyMap(map, {}));
  state.counters["blocks"] = static_cast<double>(map.voxels.size());
}

void BM_ClassifyChangesOfAFrame(benchmark::State& state) {
  const Recorded& recorded = Recorded::Get();
  OccupancyMap occupancy = ClassifyMap(recorded.map, {});
  size_t frame = 0;
  size_t blocks = 0;
  for (auto _ : state) {
    const auto& changed = recorded.changes[frame++ % recorded.changes.size()];
    benchmark::DoNotOptimize(occupancy.Update(recorded.map, changed, {}));
    blocks += changed.size();
  }
  state.counters["blocks"] = static_cast<double>(blocks) / static_cast<double>(frame);
}

void BM_BuildOctree(benchmark::State& state) {
  const OccupancyMap occupancy = ClassifyMap(Recorded::Get().map, {});
  OctreeOptions options;
  options.resolution = 0.01 * static_cast<double>(state.range(0));
  options.unknown = state.range(1) == 0 ? UnknownPolicy::kAbsent : UnknownPolicy::kOccupied;
  Result<OctreeBytes> octree;
  for (auto _ : state) octree = BuildOctree(occupancy, options);
  state.counters["kB"] = static_cast<double>(octree->bytes.size()) / 1000;
  state.counters["nodes"] = static_cast<double>(octree->nodes);
}

void BM_UpdateOctreeAfterAFrame(benchmark::State& state) {
  const Recorded& recorded = Recorded::Get();
  const OccupancyMap occupancy = ClassifyMap(recorded.map, {});
  const CoarsenOptions options{5, 1.0};
  OccupancyMap leaves = Coarsen(occupancy, options);
  size_t frame = 0;
  for (auto _ : state) {
    const auto& changed = recorded.changes[frame++ % recorded.changes.size()];
    benchmark::DoNotOptimize(UpdateCoarse(occupancy, changed, options, &leaves));
    benchmark::DoNotOptimize(EncodeOctree(leaves, 0.05, UnknownPolicy::kAbsent, std::nullopt));
  }
}

void BM_EncodeSnapshot(benchmark::State& state) {
  const OccupancyMap occupancy = ClassifyMap(Recorded::Get().map, {});
  std::vector<uint8_t> bytes;
  for (auto _ : state) bytes = EncodeOccupancyDelta(occupancy.Snapshot());
  state.counters["kB"] = static_cast<double>(bytes.size()) / 1000;
}

void BM_DecodeSnapshot(benchmark::State& state) {
  const auto bytes = EncodeOccupancyDelta(ClassifyMap(Recorded::Get().map, {}).Snapshot());
  for (auto _ : state) benchmark::DoNotOptimize(DecodeOccupancyDelta(bytes));
}

BENCHMARK(BM_ClassifyWholeMap)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_ClassifyChangesOfAFrame)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_BuildOctree)
    ->Args({5, 0})
    ->Args({5, 1})
    ->Args({4, 0})
    ->Args({10, 0})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(BM_UpdateOctreeAfterAFrame)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_EncodeSnapshot)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_DecodeSnapshot)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace vismap

BENCHMARK_MAIN();
