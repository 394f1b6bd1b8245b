#include "map_server/answers.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "base/class_names.h"
#include "base/printable.h"
#include "exports/explain_cell.h"
#include "exports/objects_json.h"
#include "exports/ply.h"
#include "exports/statistics.h"
#include "mapfile/map_file.h"
#include "objects/object_mesh.h"
#include "objects/read_out.h"
#include "requests/request_argument.h"
#include "wire/pose_digest.h"

namespace vismap {
namespace {

std::vector<uint8_t> Bytes(const std::string& text) { return {text.begin(), text.end()}; }

// The box of a request that has one.
Eigen::AlignedBox3d BoxOf(const map_request_t& request) {
  return {Eigen::Vector3d(request.bbx_min_W), Eigen::Vector3d(request.bbx_max_W)};
}

constexpr std::string_view kPositions = "positions=", kTrajectory = "trajectory=";

Result<Answer> AnswerPositions(const MapSnapshot& map, const std::string& argument) {
  const bool with_camera = argument.starts_with(kTrajectory);
  const std::string key(with_camera ? kTrajectory : kPositions);
  size_t first = 0;
  const char* end = argument.data() + argument.size();
  const auto [stop, error] = std::from_chars(argument.data() + key.size(), end, first);
  if (error != std::errc() || stop != end)
    return Fail("argument of frames: expected " + key + "N with the number of a frame, found '" +
                PrintableText(argument, 60) + "'");
  auto positions = nlohmann::json::array();
  const std::vector<CameraPose>& trajectory = map.metadata.trajectory;
  for (size_t i = first; i < trajectory.size(); ++i) {
    const Eigen::Vector3d p_W = trajectory[i].T_W_C.translation();
    auto position = nlohmann::json::array();
    if (with_camera) position.push_back(Raw(trajectory[i].camera_id));
    for (const double coordinate : p_W) position.push_back(coordinate);
    positions.push_back(std::move(position));
  }
  return Answer{std::to_string(positions.size()) + " positions", "json", Bytes(positions.dump())};
}

/// The blocks near a surface in which the cells of the meshes of `places` begin, ascending.
std::vector<BlockIndex> CellsAround(std::span<const BlockIndex> places, const SemanticMap& map) {
  std::vector<BlockIndex> blocks;
  for (const BlockIndex& at : places) {
    for (int i = 0; i < 8; ++i)
      blocks.push_back({at.x - (i & 1), at.y - (i >> 1 & 1), at.z - (i >> 2)});
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  std::erase_if(blocks, [&](const BlockIndex& at) {
    const Block* block = map.voxels.Find(at);
    return block == nullptr || !block->surface;
  });
  return blocks;
}

void Append(const Mesh& part, Mesh* mesh) {
  const auto first = static_cast<uint32_t>(mesh->vertices.size());
  mesh->vertices.insert(mesh->vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const auto& [a, b, c] : part.triangles)
    mesh->triangles.push_back({first + a, first + b, first + c});
}

}  // namespace

Result<ObjectQuery> QueryOf(const map_request_t& request) {
  Result<ObjectQuery> query = ParseObjectQuery(request.argument);
  if (query && request.has_bbx) query->region_W = BoxOf(request);
  return query;
}

Result<Answer> AnswerObjects(const MapSnapshot& map, const ObjectQuery& query,
                             const UpDirection& up, const std::vector<ObjectSummary>& objects) {
  const Result<std::vector<ObjectSummary>> selected = SelectObjects(objects, query);
  if (!selected) return tl::unexpected(selected.error());
  return Answer{std::to_string(selected->size()) + " objects and segments", "json",
                Bytes(ObjectsJson(map.metadata.map_id, up, *selected, ClassName))};
}

Answer AnswerMeshFile(const MapSnapshot& map, const OutputOptions& options) {
  const MapProducts products = MakeProducts(map.map, map.metadata, options);
  return {std::to_string(products.mesh.triangles.size()) + " triangles", "ply",
          EncodePly(products.mesh, {map.metadata.map_id, {}})};
}

Result<Answer> AnswerSurface(const MapSnapshot& map, std::span<const ObjectSummary> objects,
                             std::span<const BlockIndex> places, const MeshingOptions& options,
                             bool points_only) {
  const std::vector<BlockIndex> blocks = CellsAround(places, map.map);
  const std::vector<ShownLabel> shown = ShowLabels(map.map.labels);
  Mesh around;
  for (const BlockMesh& block : MeshEachBlock(map.map, blocks, shown, options))
    Append(block.mesh, &around);
  Mesh surface;
  for (const Mesh& object : CutObjects(around, objects)) Append(object, &surface);
  if (surface.vertices.empty()) return Fail("none of these objects has a surface in the map");
  const std::string counts = std::to_string(objects.size()) + " objects, " +
                             std::to_string(surface.vertices.size()) + " vertices, " +
                             std::to_string(surface.triangles.size()) + " triangles";
  if (points_only) surface.triangles.clear();
  return Answer{counts, "ply", EncodePly(surface, {map.metadata.map_id, {}})};
}

Answer AnswerMapFile(const MapSnapshot& map) {
  return {HashMap(map.map), "vismap", EncodeMap(map.map, map.metadata)};
}

Answer AnswerStatistics(const MapSnapshot& map, const std::string& occupancy_digest,
                        const std::vector<MemoryLayer>& memory) {
  auto json = nlohmann::ordered_json::parse(StatisticsJson(map.map, map.metadata));
  json["occupancy_digest"] = occupancy_digest;
  json["memory"] = ToJson(memory);
  return {json["hash"].get<std::string>(), "json", Bytes(json.dump())};
}

Result<Answer> AnswerFrames(const MapSnapshot& map, const std::string& argument) {
  if (argument.starts_with(kPositions) || argument.starts_with(kTrajectory))
    return AnswerPositions(map, argument);
  if (!argument.empty() && argument != "poses")
    return Fail("argument of frames: expected nothing, poses, positions=N or trajectory=N");
  auto frames = nlohmann::json::array();
  for (const CameraPose& pose : map.metadata.trajectory) {
    frames.push_back({Raw(pose.camera_id), pose.utime});
    if (argument == "poses") frames.back().push_back(PoseDigest(pose.T_W_C));
  }
  return Answer{std::to_string(frames.size()) + " frames", "json", Bytes(frames.dump())};
}

Result<Answer> AnswerCell(const MapSnapshot& map, const OccupancyOptions& options,
                          const std::string& argument) {
  const Result<RequestArgument> read = RequestArgument::Read(argument, {"at"});
  if (!read) return tl::unexpected(read.error());
  const Result<std::vector<double>> at = read->Numbers("at", 3);
  if (!at) return tl::unexpected(at.error());
  const Result<std::string> json =
      ExplainCell(map.map, map.metadata, options, {(*at)[0], (*at)[1], (*at)[2]}, ClassName);
  if (!json) return tl::unexpected(json.error());
  return Answer{"one cell", "json", Bytes(*json)};
}

}  // namespace vismap
