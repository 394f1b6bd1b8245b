// Measures free space and octrees of a recorded map. The time of an update must be small compared
// to that of a frame. Run it on a machine that does nothing else.
#include <benchmark/benchmark.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "freespace/block_region.h"
#include "freespace/occupancy_codec.h"
#include "freespace/occupancy_map.h"
#include "freespace/occupancy_watch.h"
#include "freespace/octree_builder.h"
#include "navigation/inflate.h"
#include "support/occupancy_snapshot.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

using testing_support::SnapshotOf;

/// A map and the changes of its last frames, made once for all benchmarks.
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
  options.resolution_m = 0.01 * static_cast<double>(state.range(0));
  options.unknown = state.range(1) == 0 ? UnknownPolicy::kAbsent : UnknownPolicy::kOccupied;
  Result<OctreeBytes> octree;
  for (auto _ : state) octree = BuildOctree(occupancy, options);
  state.counters["kB"] = static_cast<double>(octree->bytes.size()) / 1000;
  state.counters["nodes"] = static_cast<double>(octree->nodes);
}

/// A map of `side` x `side` copies of the recorded map, side by side on the floor.
OccupancyMap Tiled(const OccupancyMap& map, int side) {
  constexpr int32_t kPitch = 100;  // blocks: 8 m
  OccupancyMap tiled(map.cell_size());
  map.blocks().ForEach([&](BlockIndex index, const BlockOccupancy& block) {
    for (int tile = 0; tile < side * side; ++tile) {
      const int32_t x = index.x + kPitch * (tile % side);
      tiled.Set({x, index.y + kPitch * (tile / side), index.z}, block);
    }
  });
  return tiled;
}

/// Sets one voxel of every block that a frame changed to occupied, or back to its state before.
void ToggleBlocks(const OccupancyMap& before, std::span<const BlockIndex> frame, bool occupied,
                  OccupancyMap* map) {
  for (const BlockIndex& index : frame) {
    OccupancyPlanes planes = before.At(index).Planes();
    if (occupied) planes.occupied[4] |= uint64_t{1} << 36;
    planes.free[4] &= ~planes.occupied[4];
    map->Set(index, BlockOccupancy(planes));
  }
}

/// Compares the update of an octree after a frame with a new octree of the whole map, for maps of
/// range(0)^2 rooms. The time of the update must not grow with the map. "ratio" is the time of the
/// new octree divided by that of the update.
void BM_OctreeAfterAFrame(benchmark::State& state) {
  const Recorded& recorded = Recorded::Get();
  const OccupancyMap before =
      Tiled(ClassifyMap(recorded.map, {}), static_cast<int>(state.range(0)));
  OccupancyMap map(before.cell_size());
  Require(map.Apply(SnapshotOf(before)).has_value(), "a map takes over its own snapshot");
  OctreeOptions options;
  options.unknown = state.range(1) == 0 ? UnknownPolicy::kAbsent : UnknownPolicy::kOccupied;
  const auto start = std::chrono::steady_clock::now();
  benchmark::DoNotOptimize(BuildOctree(map, options));
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  OctreeBuilder builder = *OctreeBuilder::Make(map.cell_size(), options);
  builder.Update(map, map.SortedIndices());
  const auto& frame = recorded.changes.back();
  size_t bytes = 0;
  bool occupied = false;
  std::chrono::duration<double> spent{0};
  for (auto _ : state) {
    ToggleBlocks(before, frame, occupied = !occupied, &map);
    const auto begin = std::chrono::steady_clock::now();
    builder.Update(map, frame);
    bytes = builder.Build(options.unknown)->bytes.size();
    const std::chrono::duration<double> step = std::chrono::steady_clock::now() - begin;
    state.SetIterationTime(step.count());
    spent += step;
  }
  state.counters["kB"] = static_cast<double>(bytes) / 1000;
  state.counters["blocks"] = static_cast<double>(frame.size());
  state.counters["cubes"] = static_cast<double>(builder.encoded_cubes());
  state.counters["whole_ms"] = whole.count() * 1e3;
  state.counters["ratio"] = whole.count() * static_cast<double>(state.iterations()) / spent.count();
}

/// The occupancy that each frame of a walk changed.
const std::vector<OccupancyDelta>& Walk() {
  static const std::vector<OccupancyDelta> walk = [] {
    std::vector<OccupancyDelta> deltas;
    OccupancyWatch watch({});
    testing_support::MakeRecordedMap(testing_support::BenchSequence(), 400, {},
                                     [&](const SemanticMap& map, const MapDelta& delta) {
                                       deltas.push_back(watch.Update(map, delta.changed_blocks));
                                     });
    return deltas;
  }();
  return walk;
}

/// The octrees that the exporter has, brought up to date after every frame.
class Trees {
 public:
  explicit Trees(double voxel_size)
      : builder_(*OctreeBuilder::Make(voxel_size, {})),
        inflater_(*Inflater::Make(builder_.leaves().cell_size(), {})) {}

  /// Which trees are encoded: raw and closed, or inflated, too. Returns their size [bytes].
  size_t Update(const OccupancyMap& map, std::span<const BlockIndex> changed, bool inflated) {
    const std::vector<BlockIndex> leaves = Indices(builder_.Update(map, changed));
    size_t bytes = builder_.Build(UnknownPolicy::kAbsent)->bytes.size();
    bytes += builder_.Build(UnknownPolicy::kOccupied)->bytes.size();
    if (!inflated) return bytes;
    cache_.Update(inflater_.inflated(), Indices(inflater_.Update(builder_.leaves(), leaves)));
    const auto tree = cache_.Encode(inflater_.inflated(), {.resolution_m = builder_.resolution(),
                                                           .unknown = UnknownPolicy::kOccupied});
    return bytes + tree->bytes.size();
  }

  static std::vector<BlockIndex> Indices(const OccupancyDelta& delta) {
    std::vector<BlockIndex> indices;
    for (const auto& entry : delta.blocks) indices.push_back(entry.first);
    return indices;
  }

 private:
  OctreeBuilder builder_;
  Inflater inflater_;
  OctreeCache cache_;
};

/// Of all threads [s].
double ProcessorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// Time per frame of a walk, for raw and closed trees, and with range(0) = 1 the inflated one.
/// "last_tenth" is the time of the last tenth of the frames divided by that of the first.
void BM_TreesOfAWalk(benchmark::State& state) {
  const std::vector<OccupancyDelta>& walk = Walk();
  std::vector<double> ms(walk.size());
  size_t bytes = 0;
  double processor = 0;
  for (auto _ : state) {
    OccupancyMap map(walk.front().voxel_size);
    Trees trees(map.cell_size());
    double spent = 0;
    processor = 0;
    for (size_t i = 0; i < walk.size(); ++i) {
      Require(map.Apply(walk[i]).has_value(), "a map takes its own changes");
      const auto begin = std::chrono::steady_clock::now();
      const double processor_begin = ProcessorSeconds();
      bytes = trees.Update(map, Trees::Indices(walk[i]), state.range(0) == 1);
      const std::chrono::duration<double> step = std::chrono::steady_clock::now() - begin;
      processor += ProcessorSeconds() - processor_begin;
      ms[i] = step.count() * 1e3;
      spent += step.count();
    }
    state.SetIterationTime(spent);
  }
  const size_t tenth = walk.size() / 10;
  const double all = std::accumulate(ms.begin(), ms.end(), 0.0);
  const auto part = static_cast<std::ptrdiff_t>(tenth);
  state.counters["cpu_ms_per_frame"] = processor * 1e3 / static_cast<double>(ms.size());
  state.counters["ms_per_frame"] = all / static_cast<double>(ms.size());
  state.counters["last_tenth"] = std::accumulate(ms.end() - part, ms.end(), 0.0) /
                                 std::accumulate(ms.begin(), ms.begin() + part, 0.0);
  std::nth_element(ms.begin(), ms.begin() + part * 5, ms.end());
  state.counters["median_ms"] = ms[tenth * 5];
  state.counters["kB"] = static_cast<double>(bytes) / 1000;
}

/// The closed tree of a cube of range(0) decimetres around the camera, from the voxels of the map.
void BM_TreeOfABox(benchmark::State& state) {
  const SemanticMap& map = Recorded::Get().map;
  OctreeOptions options;
  options.unknown = UnknownPolicy::kOccupied;
  const Eigen::Vector3d half =
      Eigen::Vector3d::Constant(0.05 * static_cast<double>(state.range(0)));
  const Eigen::Vector3d center = map.last_camera_W;
  options.bounds_W = Eigen::AlignedBox3d(center - half, center + half);
  for (auto _ : state) {
    OccupancyMap space(map.voxels.voxel_size());
    const BlockRegion region = RegionAround(*options.bounds_W, 0.05, map.voxels.block_size());
    space.Update(map, BlocksIn(map.voxels.blocks(), region), {});
    benchmark::DoNotOptimize(BuildOctree(space, options));
  }
}

void BM_EncodeSnapshot(benchmark::State& state) {
  const OccupancyMap occupancy = ClassifyMap(Recorded::Get().map, {});
  std::vector<uint8_t> bytes;
  for (auto _ : state) bytes = EncodeOccupancyDelta(SnapshotOf(occupancy));
  state.counters["kB"] = static_cast<double>(bytes.size()) / 1000;
}

void BM_DecodeSnapshot(benchmark::State& state) {
  const auto bytes = EncodeOccupancyDelta(SnapshotOf(ClassifyMap(Recorded::Get().map, {})));
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
BENCHMARK(BM_OctreeAfterAFrame)
    ->Args({1, 0})
    ->Args({2, 0})
    ->Args({4, 0})
    ->Args({1, 1})
    ->Args({4, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK(BM_TreesOfAWalk)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->UseManualTime();
BENCHMARK(BM_TreeOfABox)->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_EncodeSnapshot)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_DecodeSnapshot)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace vismap

BENCHMARK_MAIN();
