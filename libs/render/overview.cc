#include "render/overview.h"

#include <algorithm>
#include <map>

namespace vismap {
namespace {

constexpr size_t kMaxSwatches = 6;

std::string NameOf(ClassId id, const ClassNamer& class_name) {
  const std::string name = class_name ? class_name(id) : "";
  return name.empty() ? "class " + std::to_string(Raw(id)) : name;
}

Rgb8 SwatchOf(const ObjectSummary& object, Coloring coloring) {
  MeshVertex vertex;
  vertex.segment = object.segments.empty() ? SegmentLabel::kNone : object.segments[0];
  vertex.instance = object.instance;
  vertex.class_id = object.class_id;
  return VertexColor(vertex, coloring);
}

// Adds a swatch for a new colour, up to kMaxSwatches.
void AddSwatch(Rgb8 color, LegendEntry* entry) {
  auto& swatches = entry->swatches;
  if (swatches.size() >= kMaxSwatches) return;
  if (std::find(swatches.begin(), swatches.end(), color) == swatches.end()) {
    swatches.push_back(color);
  }
}

std::string Counted(const std::string& name, int count) {
  return name + " x" + std::to_string(count);
}

}  // namespace

void NameObjects(std::span<const ObjectSummary> objects, const ClassNamer& class_name,
                 const View& view, Image<Rgb8>* image) {
  for (const ObjectSummary& object : objects) {
    if (object.discovered() || object.removed()) continue;
    const auto pixel = ProjectToView(view, object.box.center_W);
    if (!pixel || !(pixel->cwiseAbs().maxCoeff() < 1e6)) continue;
    const std::string name = NameOf(object.class_id, class_name);
    const int u = static_cast<int>(pixel->x()) - TextWidth(name, 0.42) / 2;
    const int v = static_cast<int>(pixel->y()) + 4;
    DrawText(name, u, v, 0.42, {255, 255, 255}, image, 3);
    DrawText(name, u, v, 0.42, {20, 20, 20}, image);
  }
}

Caption CaptionOf(std::span<const ObjectSummary> objects, const ClassNamer& class_name,
                  const std::string& title, const OverviewOptions& options) {
  Caption caption;
  caption.title = title;
  caption.scale = options.scale;
  if (!options.scale) caption.legend = MakeLegend(objects, options.coloring, class_name);
  return caption;
}

std::vector<LegendEntry> MakeLegend(std::span<const ObjectSummary> objects, Coloring coloring,
                                    const ClassNamer& class_name) {
  struct Group {
    LegendEntry entry;
    int count = 0;
  };
  std::map<ClassId, Group> classes;
  Group unnamed, unknown, structure;
  for (const ObjectSummary& object : objects) {
    if (object.removed()) continue;
    Group& group = object.is_structure()                  ? structure
                   : object.discovered()                  ? unknown
                   : object.class_id == ClassId::kUnknown ? unnamed
                                                          : classes[object.class_id];
    ++group.count;
    if (coloring != Coloring::kRgb) AddSwatch(SwatchOf(object, coloring), &group.entry);
  }
  std::vector<LegendEntry> legend;
  const auto add = [&](const std::string& name, Group& group) {
    if (group.count == 0) return;
    group.entry.text = Counted(name, group.count);
    legend.push_back(group.entry);
  };
  for (auto& [id, group] : classes) add(NameOf(id, class_name), group);
  add("instance without class", unnamed);
  add("unknown object", unknown);
  add("structure", structure);
  if (coloring != Coloring::kRgb) legend.push_back({{kUnsegmentedColor}, "not segmented"});
  return legend;
}

Image<Rgb8> RenderMapOverview(const Mesh& mesh, std::span<const ObjectSummary> objects,
                              const ClassNamer& class_name, const std::string& title,
                              const OverviewOptions& options) {
  Require(options.width >= 320 && options.height >= 240,
          "an overview has at least 320 x 240 pixels");
  const int picture_height = options.height - kTitleRows - LegendRows(options.height);
  const int left_width = options.width * 3 / 5;

  Image<Rgb8> pictures(options.width, picture_height, kBackground);
  const SceneBox scene = FrameScene(mesh, options.up_W ? *options.up_W : EstimateUp(mesh));
  const View left = BestPerspectiveView(mesh, scene, left_width, picture_height);
  const View right = TopDownView(scene, options.width - left_width, picture_height);
  Image<Rgb8> perspective = RenderMesh(mesh, left, options.coloring);
  if (options.name_objects) NameObjects(objects, class_name, left, &perspective);
  Paste(perspective, 0, 0, &pictures);
  Paste(RenderMesh(mesh, right, options.coloring), left_width, 0, &pictures);
  Caption caption = CaptionOf(objects, class_name, title, options);
  caption.pixels_per_metre = right.scale;
  return WithCaption(pictures, caption, options.height);
}

}  // namespace vismap
