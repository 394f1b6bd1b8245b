#include <set>

#include "base/class_names.h"
#include "datasets/text_file.h"
#include "evaluation/class_list.h"
#include "evaluation/ground_truth.h"
#include "evaluation/xml_labels.h"
#include "exports/ply.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;
using Attributes = std::map<std::string, std::string>;

std::string Value(const Attributes& attributes, const char* key) {
  const auto found = attributes.find(key);
  return found == attributes.end() ? "" : found->second;
}

// The name of a label's class: `kind`, which our exports write, or SceneNN's `nyu_class`.
std::string KindOf(const Attributes& attributes) {
  const std::string kind = Value(attributes, "kind");
  return kind.empty() ? Value(attributes, "nyu_class") : kind;
}

ClassId ClassOf(const Attributes& attributes) {
  if (const auto paper = PaperClassFromName(KindOf(attributes))) return *paper;
  if (attributes.contains("coco_id"))
    return ClassId{static_cast<uint16_t>(ParseInteger(Value(attributes, "coco_id")).value_or(0))};
  return ClassFromName(Value(attributes, "text")).value_or(ClassId::kUnknown);
}

Result<TrueObject> ToObject(const Attributes& attributes, const std::string& name) {
  const auto label = ParseInteger(Value(attributes, "id"));
  if (!label || *label < 0 || *label > std::numeric_limits<uint32_t>::max()) {
    return Fail(name + ": expected label elements with id=\"NUMBER\", found '" +
                Value(attributes, "id") + "'");
  }
  const std::string kind = KindOf(attributes);
  TrueObject object;
  object.label = static_cast<uint32_t>(*label);
  object.name = kind.empty() ? Value(attributes, "text") : kind;
  object.class_id = ClassOf(attributes);
  object.is_structure = kind == "wall" || kind == "floor" || kind == "ceiling";
  if (const auto frames = ParseInteger(Value(attributes, "frames")))
    object.frames = static_cast<int>(*frames);
  return object;
}

Result<std::vector<TrueObject>> ReadAnnotation(const fs::path& path) {
  const Result<std::string> text = ReadTextFile(path);
  if (!text) return tl::unexpected(text.error());
  const auto labels = ParseXmlLabels(*text, path.string());
  if (!labels) return tl::unexpected(labels.error());
  std::vector<TrueObject> objects;
  std::set<uint32_t> seen;
  for (const Attributes& attributes : *labels) {
    const Result<TrueObject> object = ToObject(attributes, path.string());
    if (!object) return tl::unexpected(object.error());
    if (!seen.insert(object->label).second)
      return Fail(path.string() + ": expected one label per id, found two labels with the id " +
                  std::to_string(object->label));
    if (object->label != 0 && !Value(attributes, "text").empty()) objects.push_back(*object);
  }
  return objects;
}

}  // namespace

Result<GroundTruth> ReadSceneNnTruth(const fs::path& folder) {
  GroundTruth truth;
  truth.name = folder.filename().string();
  truth.format = "scenenn";
  const Result<PlyFile> ply = ReadPly(folder / (truth.name + ".ply"));
  if (!ply) return tl::unexpected(ply.error());
  Result<std::vector<TrueObject>> objects = ReadAnnotation(folder / (truth.name + ".xml"));
  if (!objects) return tl::unexpected(objects.error());
  truth.objects = std::move(*objects);
  for (const MeshVertex& vertex : ply->mesh.vertices) {
    truth.points_W.push_back(vertex.position_W);
    truth.labels.push_back(Raw(vertex.segment));  // `label` is read as segment
  }
  truth.triangles = ply->mesh.triangles;
  return truth;
}

}  // namespace vismap
