// Maps a sequence in one process and prints the time of each stage per frame: median and 95th
// percentile, the target, the time of the published code (Grinvald 2019; up to 3 m, without free
// space), and the time of the naive reference on the same input in the same run
// (tests/support/naive; one thread, every k-th frame). The exit code is 1 if the results of the
// naive reference differ.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/parallel.h"
#include "mapfile/map_file.h"
#include "meshing/marching_cubes.h"
#include "objects/read_out.h"
#include "sequence_mapper/stage_times.h"
#include "runtime/command_line.h"
#include "session/derived_options.h"
#include "support/mesh_blocks.h"
#include "support/naive/compute_surface.h"
#include "support/naive/mesh_block.h"
#include "support/pipelines.h"
#include "support/recorded_map.h"

namespace vismap {
namespace {

using testing_support::InputFrame;
using testing_support::InputSequence;
using testing_support::MeshBlocks;

struct Arguments {
  std::string dataset = testing_support::BenchSequence();
  int frames = 150;
  int threads = 2;
  std::vector<double> ranges{5, 3};
  int naive_every = 25;
  std::string json;
};

/// A row of the table; 0 = no such figure.
struct Row {
  const char* stage;
  double target_ms;
  double published_ms;
};
constexpr Row kRows[] = {
    {"segmentation", 10, 1141}, {"  holes", 0, 0},      {"  surface, normals", 0, 0},
    {"  edges, regions", 0, 0}, {"  refinement", 0, 0}, {"association", 3, 37},
    {"integration", 10, 219},   {"total", 23, 1401},    {"total at 2 cm", 16, 0},
    {"mesh of changes", 5, 0},  {"saving", 150, 0},     {"loading", 150, 0}};

/// The times of all stages, with the names above.
struct Measurement {
  StageTimes fast, naive;
  StageTimes ratios;  // time of naive / time of fast, for the same frame
  int naive_frames = 0, naive_differences = 0;
  size_t surface_blocks = 0;
};

/// Runs `work`, adds its duration to `*ms`, and returns its result.
template <typename Work>
auto Timed(double* ms, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  auto result = work();
  *ms +=
      std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

/// The times of the stages of one frame [ms], with the names above.
struct FrameTimes {
  double holes = 0, surface = 0, segments = 0, refinement = 0, association = 0, integration = 0;

  std::vector<std::pair<std::string, double>> Stages() const {
    const double segmentation = holes + surface + segments + refinement;
    return {{"segmentation", segmentation},  {"  holes", holes},
            {"  surface, normals", surface}, {"  edges, regions", segments},
            {"  refinement", refinement},    {"association", association},
            {"integration", integration},    {"total", segmentation + association + integration}};
  }
};

void Add(const FrameTimes& times, StageTimes* sums) {
  for (const auto& [stage, ms] : times.Stages()) sums->Add(stage, ms);
}

void AddRatios(const FrameTimes& slow, const FrameTimes& fast, StageTimes* ratios) {
  const auto numerators = slow.Stages(), denominators = fast.Stages();
  for (size_t i = 0; i < numerators.size(); ++i)
    ratios->Add(numerators[i].first, numerators[i].second / denominators[i].second);
}

bool SameAssociation(const FrameAssociation& a, const FrameAssociation& b) {
  const auto same = [](const FrameAssociation::Segment& x, const FrameAssociation::Segment& y) {
    return x.label == y.label && x.instance == y.instance && x.cut_from == y.cut_from;
  };
  return std::ranges::equal(a.segments, b.segments, same) && a.together == b.together &&
         a.apart == b.apart;
}

SemanticMap Copy(const SemanticMap& map) {
  return std::move(DecodeMap(EncodeMap(map, {}), "copy")->map);
}

class Bench {
 public:
  Bench(double voxel_size, double range, bool whole) : map_({voxel_size, 4}), whole_(whole) {
    options_.integration.max_range_m = options_.integration.free_space_range_m = range;
    DeriveOptions(SurfaceOptions{}, &options_);
  }

  /// Maps a frame. `compare` = run the naive stages on it, too.
  void Map(const InputFrame& input, bool compare, Measurement* out) {
    const PinholeCamera& camera = input.frame.header.camera;
    FrameTimes fast;
    RgbdFrame filled = input.frame;
    Timed(&fast.holes, [&] {
      FillHoles({}, &filled.depth);
      return true;
    });
    const SurfaceMap surface =
        Timed(&fast.surface, [&] { return ComputeSurface(filled.depth, camera, {}); });
    SegmentImage image = Timed(&fast.segments, [&] { return SegmentDepth(surface, camera, {}); });
    RgbdFrame frame = filled;
    FrameTimes slow;
    if (compare) CompareSegments(input, surface, image, &slow, out);
    const SegmentedFrame segmented = Timed(&fast.refinement, [&] {
      return RefineWithDetections(std::move(frame), std::move(image), input.Detections(), {});
    });
    const FrameAssociation association = Timed(&fast.association, [&] {
      return Associate(segmented, {map_.voxels, map_.labels}, options_.association);
    });
    std::optional<SemanticMap> before;
    if (compare) before = Copy(map_);
    const MapDelta delta = Timed(&fast.integration, [&] {
      return IntegrateFrame(segmented, association, options_.integration, &map_);
    });
    Add(fast, &out->fast);
    if (compare) CompareMaps(segmented, association, &*before, fast, &slow, out);
    if (whole_) UpdateMesh(delta, compare, out);
  }

  /// Saves and loads the map a few times.
  void SaveAndLoad(Measurement* out) const {
    const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                       ("vismap_bench_" + std::to_string(getpid()) + ".vismap");
    for (int i = 0; i < 7; ++i) {
      double saving = 0, loading = 0;
      const auto saved = Timed(&saving, [&] { return SaveMap(map_, {}, path); });
      const auto loaded = Timed(&loading, [&] { return LoadMap(path); });
      if (!saved || !loaded) throw std::runtime_error("the map cannot be saved and loaded");
      out->fast.Add("saving", saving);
      out->fast.Add("loading", loading);
    }
    std::filesystem::remove(path);
    out->surface_blocks = MeasureMemory(map_.voxels).surface_blocks;
  }

 private:
  static void CompareSegments(const InputFrame& input, const SurfaceMap& surface,
                              const SegmentImage& image, FrameTimes* slow, Measurement* out) {
    const PinholeCamera& camera = input.frame.header.camera;
    const Image<float> depth =
        Timed(&slow->holes, [&] { return naive::FillHoles(input.frame.depth, {}); });
    Timed(&slow->surface, [&] { return naive::ComputeSurface(depth, camera, {}); });
    const SegmentImage naive_image =
        Timed(&slow->segments, [&] { return naive::SegmentDepth(surface, camera, {}); });
    if (!(naive_image.index == image.index)) ++out->naive_differences;
  }

  /// `before` is the map before the frame; it is changed.
  void CompareMaps(const SegmentedFrame& frame, const FrameAssociation& association,
                   SemanticMap* before, const FrameTimes& fast, FrameTimes* slow,
                   Measurement* out) const {
    const FrameAssociation naive_association = Timed(&slow->association, [&] {
      return naive::Associate(frame, {before->voxels, before->labels}, options_.association);
    });
    Timed(&slow->integration,
          [&] { return naive::IntegrateFrame(frame, association, options_.integration, before); });
    if (!SameAssociation(association, naive_association)) ++out->naive_differences;
    if (HashMap(*before) != HashMap(map_)) ++out->naive_differences;
    ++out->naive_frames;
    slow->refinement = fast.refinement;  // refinement has no naive version
    Add(*slow, &out->naive);
    AddRatios(*slow, fast, &out->ratios);
  }

  void UpdateMesh(const MapDelta& delta, bool compare, Measurement* out) const {
    const char* const stage = "mesh of changes";
    double fast = 0, slow = 0;
    const std::vector<BlockMesh> meshes =
        Timed(&fast, [&] { return MeshBlocks(map_, delta.changes(), ShowLabels(map_.labels)); });
    out->fast.Add(stage, fast);
    if (!compare) return;
    for (const BlockMesh& block : meshes) {
      const auto triangles = Timed(&slow, [&] { return naive::MeshBlock(map_, block.block, {}); });
      if (naive::SortedTriangles(block.mesh) != triangles) ++out->naive_differences;
    }
    out->naive.Add(stage, slow);
    out->ratios.Add(stage, slow / fast);
  }

  SemanticMap map_;
  bool whole_;  // whether meshes are updated, too
  MapSessionOptions options_;
};

Measurement Measure(const InputSequence& sequence, double range, int naive_every) {
  Measurement fine;
  Bench at_1_cm(0.01, range, true), at_2_cm(0.02, range, false);
  for (size_t i = 0; i < sequence.size(); ++i) {
    // The middle frame of every k frames, so that the map is not empty.
    const auto k = static_cast<size_t>(naive_every);
    const bool compare = k > 0 && i % k == k / 2;
    at_1_cm.Map(sequence.Read(i), compare, &fine);
  }
  at_1_cm.SaveAndLoad(&fine);
  for (size_t i = 0; i < sequence.size(); ++i) {
    Measurement one;
    at_2_cm.Map(sequence.Read(i), false, &one);
    fine.fast.Add("total at 2 cm", one.fast.Of("total").median);
  }
  return fine;
}

std::string Cell(double value, int digits, const char* unit = "") {
  if (value <= 0) return "-";
  char text[40];
  std::snprintf(text, sizeof(text), "%.*f%s", digits, value, unit);
  return text;
}

void PrintTable(double range, const Measurement& measured) {
  std::printf("\nup to %g m, 1 cm voxels, free space on; ms per frame\n", range);
  std::printf("%-18s %8s %8s %7s %10s %7s %9s %7s\n", "stage", "median", "p95", "target",
              "published", "ratio", "naive", "ratio");
  for (const Row& row : kRows) {
    const StageTimes::Figures fast = measured.fast.Of(row.stage);
    const double naive = measured.naive.Of(row.stage).median;
    const double ratio = measured.ratios.Of(row.stage).median;
    std::printf("%-18s %8s %8s %7s %10s %7s %9s %7s\n", row.stage, Cell(fast.median, 1).c_str(),
                Cell(fast.p95, 1).c_str(), Cell(row.target_ms, 0).c_str(),
                Cell(row.published_ms, 0).c_str(),
                Cell(row.published_ms / fast.median, 0, "x").c_str(), Cell(naive, 0).c_str(),
                Cell(ratio, 0, "x").c_str());
  }
  std::printf("naive references on %d frames: %s; %zu surface blocks at the end\n",
              measured.naive_frames,
              measured.naive_differences == 0
                  ? "equal results"
                  : (std::to_string(measured.naive_differences) + " DIFFERENT RESULTS").c_str(),
              measured.surface_blocks);
}

nlohmann::ordered_json TableJson(double range, const Measurement& measured) {
  nlohmann::ordered_json table{{"range_m", range},
                               {"naive_frames", measured.naive_frames},
                               {"naive_differences", measured.naive_differences}};
  for (const Row& row : kRows) {
    const StageTimes::Figures fast = measured.fast.Of(row.stage);
    std::string name = row.stage;
    name.erase(0, name.find_first_not_of(' '));
    table["stages_ms"][name] = {{"median", fast.median},
                                {"p95", fast.p95},
                                {"target", row.target_ms},
                                {"published", row.published_ms},
                                {"naive", measured.naive.Of(row.stage).median},
                                {"naive_over_fast", measured.ratios.Of(row.stage).median}};
  }
  return table;
}

/// "model, n cores, load average x". The load shows whether the machine was busy.
std::string Machine() {
  std::ifstream cpus("/proc/cpuinfo"), loads("/proc/loadavg");
  std::string line, model = "unknown processor", load;
  while (std::getline(cpus, line)) {
    if (line.rfind("model name", 0) == 0) model = line.substr(line.find(':') + 2);
  }
  loads >> load;
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) +
         " cores, load average " + load;
}

int Run(const Arguments& arguments) {
  const ThreadLimit limit(arguments.threads);
  DatasetOptions selection;
  selection.max_frames = arguments.frames;
  const InputSequence sequence(arguments.dataset, selection);
  const std::string machine = Machine();
  std::printf("%s\n%s: %zu frames, %d threads\n", machine.c_str(), arguments.dataset.c_str(),
              sequence.size(), arguments.threads);
  nlohmann::ordered_json json{{"machine", machine},
                              {"dataset", arguments.dataset},
                              {"frames", sequence.size()},
                              {"threads", arguments.threads}};
  int differences = 0;
  for (const double range : arguments.ranges) {
    const Measurement measured = Measure(sequence, range, arguments.naive_every);
    PrintTable(range, measured);
    json["tables"].push_back(TableJson(range, measured));
    differences += measured.naive_differences;
  }
  if (!arguments.json.empty()) std::ofstream(arguments.json) << json.dump(1) << "\n";
  return differences == 0 ? 0 : 1;
}

}  // namespace
}  // namespace vismap

int main(int argc, char** argv) {
  vismap::Arguments arguments;
  vismap::CommandLine line("pipeline_bench",
                           "Times the stages of the pipeline, beside their naive references.");
  line.Option("--dataset", &arguments.dataset,
              "Sequence; when not given, 7scenes in VISMAP_DATA, else the built-in room");
  line.Option("--frames", &arguments.frames, "At most so many frames").Positive();
  line.Option("--threads", &arguments.threads, "Threads to use").Positive();
  line.Option("--range", &arguments.ranges, "Farthest surface and free space [m], one table each")
      .Positive();
  line.Option("--naive-every", &arguments.naive_every,
              "The naive references see one frame of so many; 0 = none")
      .AtLeast(0);
  line.Option("--json", &arguments.json, "Writes the figures to this file, too");
  if (const auto end = line.Parse(argc, argv)) return static_cast<int>(*end);
  line.Apply();
  try {
    return vismap::Run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pipeline_bench: %s\n", error.what());
    return 3;
  }
}
