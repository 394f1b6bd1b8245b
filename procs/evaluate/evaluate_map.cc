#include "evaluate/evaluate_map.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "base/json_text.h"
#include "evaluate/truth_source.h"
#include "evaluation/report.h"
#include "exports/outputs.h"
#include "exports/ply.h"
#include "freespace/coarsen.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

// Allows for a few cells and for gaps between the points of the ground truth [m].
constexpr double kFarFromTruth = 0.15;

struct MapInput {
  EvaluatedMap map;
  std::optional<OccupancyMap> occupancy;  ///< only of saved maps
};

// Reads the score of each instance from an objects.json.
Result<std::map<InstanceId, double>> ReadScores(const fs::path& path) {
  constexpr uint64_t kMaxObjectsBytes = uint64_t{1} << 28;
  const auto bytes = ReadFileBytes(path, kMaxObjectsBytes);
  if (!bytes) return tl::unexpected(bytes.error());
  std::map<InstanceId, double> scores;
  try {
    const Result<nlohmann::json> json =
        ParseJson({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    if (!json) return Fail(path.string() + ": " + json.error().message);
    for (const auto& object : json->at("objects"))
      scores[InstanceId{object.at("instance").get<uint32_t>()}] = object.at("score").get<double>();
  } catch (const nlohmann::json::exception& error) {
    return Fail(path.string() + ": expected objects with instance and score: " + error.what());
  }
  return scores;
}

// Distances to a vertex without a place would make all scores NaN.
Result<void> CheckPlaces(const Mesh& mesh, const std::string& path) {
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!mesh.vertices[i].position_W.allFinite())
      return Fail(path + ": vertex " + std::to_string(i) +
                  ": expected finite coordinates, found NaN or infinity");
  }
  return {};
}

Result<MapInput> ReadMesh(const EvaluateArguments& arguments) {
  Result<PlyFile> ply = ReadPly(arguments.map);
  if (!ply) return tl::unexpected(ply.error());
  if (const Result<void> places = CheckPlaces(ply->mesh, arguments.map); !places)
    return tl::unexpected(places.error());
  MapInput input;
  input.map.mesh = std::move(ply->mesh);
  fs::path objects = arguments.objects;
  if (objects.empty()) {
    objects = fs::path(arguments.map).parent_path() / "objects.json";
    if (!fs::exists(objects)) return input;
  }
  Result<std::map<InstanceId, double>> scores = ReadScores(objects);
  if (!scores) return tl::unexpected(scores.error());
  input.map.scores = std::move(*scores);
  return input;
}

Result<MapInput> ReadMap(const EvaluateArguments& arguments) {
  if (fs::path(arguments.map).extension() == ".ply") return ReadMesh(arguments);
  const Result<LoadedMap> loaded =
      LoadMap(arguments.map, MaxMapBytes(arguments.config.integration));
  if (!loaded) return tl::unexpected(loaded.error());
  const OutputOptions options = arguments.config;
  MapProducts products = MakeProducts(loaded->map, loaded->metadata, options);
  MapInput input;
  input.map.mesh = std::move(products.mesh);
  input.map.scores.emplace();
  for (const ObjectSummary& object : products.objects) {
    // Round as objects.json does, so that a map and its mesh get the same results.
    if (!object.discovered() && !object.removed())
      (*input.map.scores)[object.instance] = std::round(object.score * 1e6) / 1e6;
  }
  input.occupancy = ClassifyMap(loaded->map, options.free_space);
  return input;
}

Result<FreeSpaceEvaluation> ScoreCells(const OccupancyMap& cells, const TruthSource& source) {
  FreeSpaceEvaluation result;
  result.cell_size = cells.cell_size();
  result.truth = CellsAt(cells, source.truth.points_W);
  result.occupied = CountOccupied(cells, source.truth.points_W, kFarFromTruth);
  if (source.depth) {
    const Result<RayScore> rays = ScoreRays(cells, **source.depth, {});
    if (!rays) return tl::unexpected(rays.error());
    result.rays = *rays;
  }
  if (source.distance) result.analytic = ScoreFreeSpace(cells, source.distance, cells.cell_size());
  return result;
}

// Evaluates the voxels of the map and the larger cells of its octree, which planners use.
Result<std::vector<FreeSpaceEvaluation>> ScoreOccupancy(const OccupancyMap& voxels,
                                                        const TruthSource& source,
                                                        const OutputOptions& options) {
  const auto grid = ChooseOctreeGrid(voxels.cell_size(), options.octree.resolution_m);
  if (!grid) return tl::unexpected(grid.error());
  const OccupancyMap leaves = Coarsen(voxels, {grid->factor, options.octree.free_fraction});
  std::vector<FreeSpaceEvaluation> results;
  for (const OccupancyMap* cells : {&voxels, &leaves}) {
    Result<FreeSpaceEvaluation> result = ScoreCells(*cells, source);
    if (!result) return tl::unexpected(result.error());
    results.push_back(std::move(*result));
  }
  return results;
}

Result<Evaluation> EvaluateFiles(const EvaluateArguments& arguments, const TruthSource& source,
                                 const std::vector<EvaluatedClass>& classes) {
  const Result<MapInput> input = ReadMap(arguments);
  if (!input) return tl::unexpected(input.error());
  Evaluation evaluation = Evaluate(source.truth, input->map, classes);
  if (!input->occupancy) return evaluation;
  if (!source.depth)
    LogWarning("the free space is not compared with depth images: " + source.depth.error().message);
  auto free_space = ScoreOccupancy(*input->occupancy, source, arguments.config);
  if (!free_space) return tl::unexpected(free_space.error());
  evaluation.free_space = std::move(*free_space);
  return evaluation;
}

}  // namespace

Outcome RunEvaluate(const EvaluateArguments& arguments) {
  const Result<TruthSource> source = OpenTruth(arguments.ground_truth);
  if (!source) return ExitWith(ExitCode::kUnreadable, source.error().message);
  const auto classes = ParseClassList(arguments.classes, source->truth);
  if (!classes) return ExitWith(ExitCode::kUsage, classes.error().message);
  const Result<Evaluation> evaluation = EvaluateFiles(arguments, *source, *classes);
  if (!evaluation) return ExitWith(ExitCode::kUnreadable, evaluation.error().message);
  const std::string json = EvaluationJson(*evaluation);
  std::fputs(arguments.json ? json.c_str() : EvaluationTable(*evaluation).c_str(), stdout);
  if (arguments.why && !arguments.json)
    std::fputs(("\n" + FindingsTable(*evaluation)).c_str(), stdout);
  if (arguments.out.empty()) return {};
  const Result<void> written = WriteFileAtomically(arguments.out, json);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  return {};
}

}  // namespace vismap
