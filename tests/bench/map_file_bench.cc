// Measures saving and loading of a recorded map.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>

#include "mapfile/map_file.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

const SemanticMap& RecordedMap() {
  static const SemanticMap map = testing_support::MakeRecordedMap(
      testing_support::BenchSequence(), 150, {}, [](const SemanticMap&, const MapDelta&) {});
  return map;
}

std::filesystem::path TemporaryFile() {
  return std::filesystem::temp_directory_path() /
         ("vismap_bench_" + std::to_string(getpid()) + ".vismap");
}

void Describe(const SemanticMap& map, uint64_t bytes, benchmark::State* state) {
  const VoxelMapMemory memory = MeasureMemory(map.voxels);
  state->counters["surface_blocks"] = static_cast<double>(memory.surface_blocks);
  state->counters["blocks"] = static_cast<double>(map.voxels.size());
  state->counters["MB"] = static_cast<double>(bytes) / 1e6;
}

void BM_SaveMap(benchmark::State& state) {
  const SemanticMap& map = RecordedMap();
  const std::filesystem::path path = TemporaryFile();
  uint64_t bytes = 0;
  for (auto _ : state) bytes = SaveMap(map, {}, path)->bytes;
  Describe(map, bytes, &state);
  std::filesystem::remove(path);
}

void BM_EncodeMap(benchmark::State& state) {
  const SemanticMap& map = RecordedMap();
  for (auto _ : state) benchmark::DoNotOptimize(EncodeMap(map, {}));
}

void BM_LoadMap(benchmark::State& state) {
  const std::filesystem::path path = TemporaryFile();
  const uint64_t bytes = SaveMap(RecordedMap(), {}, path)->bytes;
  for (auto _ : state) benchmark::DoNotOptimize(LoadMap(path));
  Describe(RecordedMap(), bytes, &state);
  std::filesystem::remove(path);
}

void BM_HashMap(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(HashMap(RecordedMap()));
}

BENCHMARK(BM_SaveMap)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_EncodeMap)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_LoadMap)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_HashMap)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace vismap

BENCHMARK_MAIN();
