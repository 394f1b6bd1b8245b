#include "render/overview.h"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>

namespace vismap {
namespace {

constexpr int kMargin = 12;
constexpr int kTitleRows = 36;
constexpr int kLegendRow = 22;
constexpr size_t kMaxSwatches = 6;

// A view of the pixels of an image for OpenCV's drawing functions.
cv::Mat AsMat(Image<Rgb8>* image) {
  return {image->height(), image->width(), CV_8UC3, image->data()};
}

cv::Scalar ToScalar(Rgb8 color) {
  return {static_cast<double>(color.r), static_cast<double>(color.g), static_cast<double>(color.b)};
}

constexpr Rgb8 kInk{40, 40, 40};

void PutText(const cv::Mat& mat, const std::string& text, cv::Point at, double size, Rgb8 color,
             int thickness = 1) {
  cv::putText(mat, text, at, cv::FONT_HERSHEY_SIMPLEX, size, ToScalar(color), thickness,
              cv::LINE_AA);
}

int TextWidth(const std::string& text, double size) {
  int baseline = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline).width;
}

void Paste(const Image<Rgb8>& part, int u, int v, Image<Rgb8>* whole) {
  for (int row = 0; row < part.height(); ++row) {
    std::copy_n(part.row(row), part.width(), whole->row(v + row) + u);
  }
}

std::string NameOf(ClassId id, const ClassNamer& class_name) {
  const std::string name = class_name ? class_name(id) : "";
  return name.empty() ? "class " + std::to_string(Raw(id)) : name;
}

// Writes the class name at the centre of each object, in dark letters with a light outline.
void NameObjects(std::span<const ObjectSummary> objects, const ClassNamer& class_name,
                 const View& view, Image<Rgb8>* image) {
  const cv::Mat mat = AsMat(image);
  for (const ObjectSummary& object : objects) {
    if (object.discovered() || object.removed()) continue;
    const auto pixel = ProjectToView(view, object.box.center_W);
    if (!pixel) continue;
    const std::string name = NameOf(object.class_id, class_name);
    const cv::Point at(static_cast<int>(pixel->x()) - TextWidth(name, 0.42) / 2,
                       static_cast<int>(pixel->y()) + 4);
    PutText(mat, name, at, 0.42, {255, 255, 255}, 3);
    PutText(mat, name, at, 0.42, {20, 20, 20}, 1);
  }
}

int EntryWidth(const LegendEntry& entry) {
  return static_cast<int>(entry.swatches.size()) * 18 + 8 + TextWidth(entry.text, 0.48) + 24;
}

// Writes the entries in columns from the top. If not all fit, the last line tells how many are
// missing.
void DrawLegend(const std::vector<LegendEntry>& entries, const cv::Rect& area, const cv::Mat& mat) {
  const int rows = std::max(1, area.height / kLegendRow);
  int u = area.x;
  for (size_t first = 0; first < entries.size(); first += static_cast<size_t>(rows)) {
    const size_t last = std::min(entries.size(), first + static_cast<size_t>(rows));
    int width = 0;
    for (size_t i = first; i < last; ++i) width = std::max(width, EntryWidth(entries[i]));
    if (u + width > area.x + area.width && first > 0) {
      PutText(mat, "+" + std::to_string(entries.size() - first) + " more",
              {u, area.y + kLegendRow - 6}, 0.48, kInk);
      return;
    }
    for (size_t i = first; i < last; ++i) {
      const int v = area.y + static_cast<int>(i - first) * kLegendRow;
      int at = u;
      for (const Rgb8 color : entries[i].swatches) {
        cv::rectangle(mat, cv::Rect(at, v + 3, 15, 15), ToScalar(color), cv::FILLED);
        cv::rectangle(mat, cv::Rect(at, v + 3, 15, 15), ToScalar({120, 120, 120}), 1);
        at += 18;
      }
      PutText(mat, entries[i].text, {at + 6, v + 16}, 0.48, kInk);
    }
    u += width;
  }
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
  const int legend_rows = std::max(3, options.height / 7 / kLegendRow);
  const int legend_height = legend_rows * kLegendRow + kMargin;
  const int picture_height = options.height - kTitleRows - legend_height;
  const int left_width = options.width * 3 / 5;

  Image<Rgb8> overview(options.width, options.height, kBackground);
  const SceneBox scene = FrameScene(mesh, options.up_W ? *options.up_W : EstimateUp(mesh));
  const View left = BestPerspectiveView(mesh, scene, left_width, picture_height);
  const View right = TopDownView(scene, options.width - left_width, picture_height);
  Image<Rgb8> perspective = RenderMesh(mesh, left, options.coloring);
  if (options.name_objects) NameObjects(objects, class_name, left, &perspective);
  Paste(perspective, 0, kTitleRows, &overview);
  Paste(RenderMesh(mesh, right, options.coloring), left_width, kTitleRows, &overview);

  const cv::Mat mat = AsMat(&overview);
  PutText(mat, title, {kMargin, kTitleRows - 12}, 0.62, kInk);
  DrawLegend(MakeLegend(objects, options.coloring, class_name),
             {kMargin, options.height - legend_height, options.width - 2 * kMargin,
              legend_rows * kLegendRow},
             mat);
  return overview;
}

}  // namespace vismap
