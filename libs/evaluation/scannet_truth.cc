#include <nlohmann/json.hpp>
#include <sstream>

#include "base/class_names.h"
#include "base/json_text.h"
#include "datasets/text_file.h"
#include "evaluation/class_list.h"
#include "evaluation/ground_truth.h"
#include "exports/ply.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;
using ClassNames = std::map<std::string, std::string>;  // raw_category -> nyu40class

const std::string kMeshEnding = "_vh_clean_2.ply";

Result<nlohmann::json> ReadJson(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return tl::unexpected(text.error());
  Result<nlohmann::json> json = ParseJson<nlohmann::json>(*text);
  if (!json) return Fail(path.string() + ": " + json.error().message);
  if (!json->is_object()) return Fail(path.string() + ": expected a JSON object");
  return json;
}

Result<std::vector<int64_t>> ReadSegments(const fs::path& path, size_t vertices) {
  const Result<nlohmann::json> json = ReadJson(path);
  if (!json) return tl::unexpected(json.error());
  const auto found = json->find("segIndices");
  if (found == json->end() || !found->is_array() || found->size() != vertices) {
    return Fail(
        path.string() + ": expected segIndices, one for each of " + std::to_string(vertices) +
        " vertices, found " +
        (found == json->end() || !found->is_array() ? "no list" : std::to_string(found->size())));
  }
  std::vector<int64_t> segments;
  for (const nlohmann::json& segment : *found) {
    if (!segment.is_number_integer())
      return Fail(path.string() + ": segIndices: expected integers, found " +
                  DescribeJson(segment));
    segments.push_back(segment.get<int64_t>());
  }
  return segments;
}

// Reads the table of the benchmark, which has tabs between the columns and a header line. Empty if
// there is no such file.
ClassNames ReadClassTable(const fs::path& folder) {
  ClassNames names;
  for (const fs::path& place : {folder, folder.parent_path(), folder.parent_path().parent_path()}) {
    const Result<std::string> text = ReadTextFile(place / "scannetv2-labels.combined.tsv");
    if (!text) continue;
    std::istringstream lines(*text);
    size_t raw = 0, nyu = 0;
    bool header = true;
    for (std::string line; std::getline(lines, line); header = false) {
      std::vector<std::string> cells;
      if (line.ends_with('\r')) line.pop_back();
      std::istringstream columns(line);
      for (std::string cell; std::getline(columns, cell, '\t');) cells.push_back(cell);
      for (size_t i = 0; header && i < cells.size(); ++i) {
        if (cells[i] == "raw_category") raw = i;
        if (cells[i] == "nyu40class") nyu = i;
      }
      if (!header && raw < cells.size() && nyu < cells.size()) names[cells[raw]] = cells[nyu];
    }
    return names;
  }
  return names;
}

// The class for frequent raw categories, for folders without the table.
std::string BuiltInClass(const std::string& raw) {
  static const ClassNames kNames{
      {"office chair", "chair"}, {"armchair", "chair"},     {"stack of chairs", "chair"},
      {"couch", "sofa"},         {"coffee table", "table"}, {"dining table", "table"},
      {"end table", "table"},    {"book", "books"},         {"tv", "television"},
      {"mini fridge", "fridge"}, {"backpack", "bag"}};
  const auto found = kNames.find(raw);
  return found == kNames.end() ? raw : found->second;
}

TrueObject ToObject(int64_t id, const std::string& raw, const ClassNames& names) {
  const auto found = names.find(raw);
  const std::string name = found == names.end() ? BuiltInClass(raw) : found->second;
  TrueObject object;
  object.label = static_cast<uint32_t>(id + 1);
  object.name = raw;
  object.class_id = PaperClassFromName(name).value_or(
      ClassFromName(name).value_or(ClassFromName(raw).value_or(ClassId::kUnknown)));
  object.is_structure = name == "wall" || name == "floor" || name == "ceiling";
  return object;
}

Result<void> ReadObjects(const fs::path& path, const ClassNames& names,
                         const std::vector<int64_t>& segments, GroundTruth* truth) {
  const Result<nlohmann::json> json = ReadJson(path);
  if (!json) return tl::unexpected(json.error());
  std::map<int64_t, uint32_t> label_of;
  try {
    for (const nlohmann::json& group : json->at("segGroups")) {
      const auto id = group.at("objectId").get<int64_t>();
      if (id < 0 || id >= std::numeric_limits<uint32_t>::max())
        return Fail(path.string() + ": objectId is " + std::to_string(id) +
                    "; expected a number in 0..4294967294");
      truth->objects.push_back(ToObject(id, group.at("label").get<std::string>(), names));
      for (const nlohmann::json& segment : group.at("segments"))
        label_of[segment.get<int64_t>()] = truth->objects.back().label;
    }
  } catch (const nlohmann::json::exception& error) {
    return Fail(path.string() +
                ": expected segGroups with objectId, label and segments, but: " + error.what());
  }
  for (const int64_t segment : segments) {
    const auto found = label_of.find(segment);
    truth->labels.push_back(found == label_of.end() ? 0 : found->second);
  }
  return {};
}

Result<std::string> FindScene(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(kMeshEnding)) return name.substr(0, name.size() - kMeshEnding.size());
  }
  return Fail(folder.string() + ": expected a file *" + kMeshEnding + ", found none");
}

}  // namespace

Result<GroundTruth> ReadScanNetTruth(const fs::path& folder) {
  const Result<std::string> scene = FindScene(folder);
  if (!scene) return tl::unexpected(scene.error());
  GroundTruth truth;
  truth.name = *scene;
  truth.format = "scannet";
  const Result<PlyFile> ply = ReadPly(folder / (*scene + kMeshEnding));
  if (!ply) return tl::unexpected(ply.error());
  for (const MeshVertex& vertex : ply->mesh.vertices) truth.points_W.push_back(vertex.position_W);
  truth.triangles = ply->mesh.triangles;
  const auto segments =
      ReadSegments(folder / (*scene + "_vh_clean_2.0.010000.segs.json"), truth.points_W.size());
  if (!segments) return tl::unexpected(segments.error());
  fs::path groups = folder / (*scene + ".aggregation.json");
  if (!fs::exists(groups)) groups = folder / (*scene + "_vh_clean.aggregation.json");
  const auto read = ReadObjects(groups, ReadClassTable(folder), *segments, &truth);
  if (!read) return tl::unexpected(read.error());
  return truth;
}

}  // namespace vismap
