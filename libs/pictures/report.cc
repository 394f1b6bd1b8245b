#include "pictures/report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/base64.h"
#include "base/class_names.h"
#include "base/format.h"
#include "exports/statistics.h"
#include "meshing/mesh_parts.h"
#include "objects/object_mesh.h"
#include "pictures/html.h"
#include "pictures/report_parts.h"
#include "pictures/report_path.h"
#include "pictures/report_space.h"
#include "pictures/report_style.h"
#include "pictures/web_mesh.h"
#include "render/overview.h"
#include "render/paint.h"
#include "render/webp.h"

namespace vismap {
namespace {

using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr int kWidth = 1200, kHeight = 720;         // of a picture [px]
constexpr int kTurnWidth = 720, kTurnHeight = 460;  // of the turntable [px]
constexpr int kTurnViews = 16, kTurnMs = 400;
constexpr int kTurnQuality = 65;
constexpr int kThumbWidth = 176, kThumbHeight = 132;  // [px]
constexpr size_t kMostThumbnails = 200;
constexpr double kElevation = 0.61;  // of the turntable [rad]

/// A part of the page.
struct Part {
  const char* id;
  const char* title;
  std::string html;
};

std::string Section(const Part& part) {
  return std::string("<section id=\"") + part.id + "\"><h2>" + part.title + "</h2>\n" + part.html +
         "</section>\n";
}

std::string IdOf(const ObjectSummary& object) {
  if (!object.discovered()) return std::to_string(Raw(object.instance));
  return object.segments.empty() ? "s0" : "s" + std::to_string(Raw(object.segments[0]));
}

std::string NameOfObject(const ObjectSummary& object) {
  if (object.is_structure()) return NameOf(object.structure);
  if (object.discovered()) return "thing";
  return object.class_id == ClassId::kUnknown ? "object" : ClassName(object.class_id);
}

std::string SizeOf(const ObjectSummary& object) {
  const Vector3d& size = object.box.size;
  return Digits(size.x(), 2) + " &times; " + Digits(size.y(), 2) + " &times; " +
         Digits(size.z(), 2);
}

double AreaOf(const Mesh& mesh) {
  double area = 0;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) area += TriangleArea(mesh, i);
  return area;
}

bool HasColor(const Mesh& mesh) {
  return std::any_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [](const MeshVertex& vertex) { return !(vertex.color == Rgb8{}); });
}

/// What of an object's mesh lies in its box: stray pieces far away would make the rest small.
Mesh MainPart(const Mesh& mesh, const ObjectSummary& object) {
  constexpr double kMargin = 0.03;  // [m]
  const Eigen::Array3d half = 0.5 * object.box.size.array() + kMargin;
  const Eigen::Matrix3d R_B_W = object.box.R_W_B.toRotationMatrix().transpose();
  const auto is_out = [&](uint32_t corner) {
    const Vector3d p_W = mesh.vertices[corner].position_W.cast<double>();
    return ((R_B_W * (p_W - object.box.center_W)).array().abs() > half).any();
  };
  std::vector<uint8_t> keep;
  for (const std::array<uint32_t, 3>& triangle : mesh.triangles)
    keep.push_back(std::none_of(triangle.begin(), triangle.end(), is_out) ? 1 : 0);
  Mesh part = KeepTriangles(mesh, keep);
  return part.triangles.empty() ? mesh : part;
}

/// Makes the parts of a report one after the other.
class Report {
 public:
  Report(const LoadedMap& loaded, const OutputOptions& options, const ReportInput& input,
         const std::function<bool(const std::string&)>& on_part)
      : loaded_(loaded),
        options_(options),
        input_(input),
        on_part_(on_part),
        trajectory_(loaded.metadata.trajectory) {}

  std::string Html() {
    if (!on_part_("surface and objects")) return "";
    products_ = MakeProducts(loaded_.map, loaded_.metadata, options_);
    scene_ = FrameScene(products_.mesh, products_.up.up_W);
    coloring_ = HasColor(products_.mesh) ? Coloring::kRgb : Coloring::kInstance;
    space_.emplace(ClassifyNearParts(loaded_.map, loaded_.metadata, options_.free_space));
    Add("summary", "Summary", &Report::Summary);
    Add("map", "Map", &Report::Map);
    Add("pictures", "Pictures", &Report::Pictures);
    Add("objects", "Objects", &Report::Objects);
    Add("discovered", "Discovered things", &Report::Discovered);
    Add("structure", "Structure", &Report::Structure);
    Add("removed", "Removed", &Report::Removed);
    Add("trajectory", "Trajectory", &Report::Trajectory);
    Add("times", "Stage times", &Report::Times);
    Add("space", "Free space", &Report::Space);
    Add("scores", "Scores", &Report::Scores);
    Add("processes", "Processes", &Report::Processes);
    Add("versions", "Versions", &Report::Versions);
    Add("config", "Config", &Report::Config);
    return is_stopped_ ? "" : Page();
  }

 private:
  void Add(const char* id, const char* title, std::string (Report::*make)()) {
    is_stopped_ = is_stopped_ || !on_part_(title);
    if (is_stopped_) return;
    parts_.push_back({id, title, (this->*make)()});
  }

  std::string Page() const {
    const std::string title =
        Escaped(loaded_.metadata.map_id.empty() ? "map" : loaded_.metadata.map_id);
    std::string html =
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; "
        "style-src 'unsafe-inline'; script-src 'unsafe-inline'\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
        title + " &ndash; vismap</title>\n<style>" + kReportStyle + "</style>\n</head>\n<body>\n" +
        "<header><h1>" + title + "</h1>\n<nav aria-label=\"Parts\">";
    for (const Part& part : parts_)
      html += std::string("<a href=\"#") + part.id + "\">" + part.title + "</a> ";
    html += "</nav></header>\n<main>\n";
    for (const Part& part : parts_) html += Section(part);
    return html + "</main>\n" + Script() + "</body>\n</html>\n";
  }

  std::string Script() const {
    if (input_.script.empty()) return "";
    return "<script type=\"application/json\" id=\"about\">" + ScriptJson(about_) +
           "</script>\n<script type=\"text/plain\" id=\"surface\">" + surface_ +
           "</script>\n<script>" + input_.script + "</script>\n";
  }

  int64_t Count(bool (*belongs)(const ObjectSummary&)) const {
    return std::count_if(products_.objects.begin(), products_.objects.end(), belongs);
  }
  static bool IsNamed(const ObjectSummary& o) { return !o.removed() && !o.discovered(); }
  static bool IsThing(const ObjectSummary& o) {
    return !o.removed() && o.discovered() && !o.is_structure();
  }
  static bool IsStructure(const ObjectSummary& o) { return !o.removed() && o.is_structure(); }
  static bool IsRemoved(const ObjectSummary& o) { return o.removed(); }

  /// From the first to the last frame [s].
  double Duration() const {
    const auto [first, last] = std::minmax_element(
        trajectory_.begin(), trajectory_.end(),
        [](const CameraPose& a, const CameraPose& b) { return a.utime < b.utime; });
    if (trajectory_.empty()) return 0;
    return (static_cast<double>(last->utime) - static_cast<double>(first->utime)) * 1e-6;
  }

  std::string Summary() {
    HtmlTable table({});
    table.Add({"made of", Escaped(input_.source)});
    table.Add({"frames", FormatCount(std::ssize(trajectory_)) + " of " +
                             FormatCount(std::ssize(CamerasOf(trajectory_)), "camera")});
    table.Add({"time from the first to the last frame", Escaped(FormatDuration(Duration()))});
    table.Add({"size", Digits(scene_.size.x(), 2) + " &times; " + Digits(scene_.size.y(), 2) +
                           " &times; " + Digits(scene_.size.z(), 2) + " m"});
    table.Add({"surface", Digits(AreaOf(products_.mesh), 1) + " m&sup2;, " +
                              FormatCount(std::ssize(products_.mesh.triangles), "triangle")});
    table.Add({"voxels of", Digits(loaded_.map.voxels.voxel_size() * 100, 1) + " cm"});
    table.Add({"objects", FormatCount(Count(IsNamed)) + ", discovered things " +
                              FormatCount(Count(IsThing)) + ", structure " +
                              FormatCount(Count(IsStructure)) + ", removed " +
                              FormatCount(Count(IsRemoved))});
    table.Add({"up", Escaped(DirectionText(products_.up.up_W) + ": " + products_.up.reason)});
    table.Add({"hash", "<code>" + Escaped(loaded_.map_hash) + "</code>"});
    return table.Html() + FindingsHtml(input_);
  }

  std::string Map() {
    if (products_.mesh.triangles.empty()) return Remark("The map has no surface.");
    std::string html;
    if (input_.script.empty()) {
      html += Remark(input_.no_script);
    } else {
      const WebMesh coarse = CoarsenMesh(products_.mesh, kMostReportVertices);
      surface_ = EncodeWebMesh(coarse.mesh, products_.objects);
      about_ = About(coarse);
      html +=
          "<div id=\"viewer\" hidden><p><label>Colour <select id=\"colouring\">"
          "<option value=\"instance\">object</option><option value=\"class\">class</option>" +
          std::string(HasColor(products_.mesh) ? "<option value=\"rgb\">as seen</option>" : "") +
          "<option value=\"height\">height</option></select></label> <span id=\"picked\" "
          "role=\"status\">Drag to turn, scroll to come nearer; a click names an "
          "object.</span></p>\n"
          "<canvas id=\"canvas\" tabindex=\"0\" aria-label=\"The map in three "
          "dimensions\"></canvas></div>\n";
      if (coarse.cell_m > 0) {
        html += "<p>Here the surface is coarser than in the map: " +
                FormatCount(std::ssize(coarse.mesh.triangles), "triangle") +
                ", vertices closer than " + Digits(coarse.cell_m * 100, 1) +
                " cm are joined.</p>\n";
      }
    }
    return html + Turntable();
  }

  std::string About(const WebMesh& coarse) const {
    Json about = Json::parse(WebMeshHeader(coarse.mesh));
    const Vector3d& up = products_.up.up_W;
    about["up"] = {up.x(), up.y(), up.z()};
    about["colored"] = coloring_ == Coloring::kRgb;
    about["objects"] = Json::array();
    for (const ObjectSummary& object : products_.objects) {
      about["objects"].push_back({{"id", IdOf(object)},
                                  {"name", NameOfObject(object)},
                                  {"instance", Raw(object.instance)},
                                  {"class", Raw(object.class_id)},
                                  {"structure", object.is_structure()}});
    }
    return about.dump(-1, ' ', false, Json::error_handler_t::replace);
  }

  /// For browsers without WebGL, and where there is no script.
  std::string Turntable() const {
    WebpAnimation animation(kTurnWidth, kTurnHeight, kTurnMs, kTurnQuality);
    for (const View& view : TurntableViews(scene_, kTurnViews, kElevation, kTurnWidth, kTurnHeight))
      animation.Add(RenderMesh(products_.mesh, view, coloring_));
    return "<figure id=\"turntable\"><img src=\"data:image/webp;base64," +
           Base64(animation.Finish()) +
           "\" alt=\"The map from all around\"><figcaption>The map from all "
           "around</figcaption></figure>\n";
  }

  std::string Pictures() {
    if (products_.mesh.triangles.empty()) return Remark("The map has no surface.");
    OverviewOptions overview;
    overview.width = kWidth;
    overview.height = kHeight;
    overview.up_W = products_.up.up_W;
    const std::string title = loaded_.metadata.map_id;
    std::string html =
        WebpFigure(RenderMapOverview(products_.mesh, products_.objects, ClassName, title, overview),
                   "By object: from the side and from above");
    if (coloring_ == Coloring::kRgb) {
      overview.coloring = Coloring::kRgb;
      overview.name_objects = false;
      html += WebpFigure(
          RenderMapOverview(products_.mesh, products_.objects, ClassName, title, overview),
          "As the cameras saw it");
    } else {
      html +=
          Remark("There is no picture in the cameras' colours, since the frames had no colour.");
    }
    Mesh heights = products_.mesh;
    overview.coloring = Coloring::kRgb;
    overview.scale = PaintHeights(products_.up.up_W, &heights);
    html += WebpFigure(RenderMapOverview(heights, products_.objects, ClassName, title, overview),
                       "By height");
    return html;
  }

  std::vector<std::string> RowOf(const ObjectSummary& object, const std::string& picture) const {
    return {picture,
            Escaped(NameOfObject(object)),
            IdOf(object),
            object.discovered() ? "" : Escaped(FormatPercent(object.score)),
            object.removed() ? "" : SizeOf(object),
            Digits(object.area, 2),
            FormatCount(object.frames)};
  }

  static std::vector<std::string> Heads() {
    return {"", "what", "id", "probability", "size [m]", "surface [m&sup2;]", "frames"};
  }

  /// The object alone, from the side that shows most of it.
  std::string Thumbnail(const Mesh& mesh, const ObjectSummary& object) {
    if (mesh.triangles.empty()) return "no surface";
    if (++thumbnails_ > kMostThumbnails) return "";
    const Mesh body = MainPart(mesh, object);
    const SceneBox box = FrameScene(body, products_.up.up_W);
    const View view = BestPerspectiveView(body, box, kThumbWidth, kThumbHeight);
    return WebpImage(RenderMesh(body, view, coloring_), Escaped(NameOfObject(object)));
  }

  std::string ListOf(bool (*belongs)(const ObjectSummary&), bool pictures) {
    if (meshes_.empty()) meshes_ = CutObjects(products_.mesh, products_.objects);
    HtmlTable table(Heads());
    for (size_t i = 0; i < products_.objects.size(); ++i) {
      const ObjectSummary& object = products_.objects[i];
      if (!belongs(object)) continue;
      table.Add(RowOf(object, pictures ? Thumbnail(meshes_[i], object) : ""),
                " data-object=\"" + std::to_string(i) + "\"");
    }
    if (table.empty()) return "";
    const bool more = pictures && thumbnails_ > kMostThumbnails;
    return table.Html() + (more ? Remark("Only the first " + FormatCount(kMostThumbnails) +
                                         " objects have a picture.")
                                : "");
  }

  std::string Objects() {
    const std::string list = ListOf(IsNamed, true);
    if (!list.empty()) return list;
    return Remark(
        Count(IsThing) > 0
            ? "The map has no objects with a class: no detections came with its frames, or "
              "they named nothing. What was found without a class is below."
            : "The map has no objects.");
  }

  std::string Discovered() {
    const std::string list = ListOf(IsThing, true);
    return list.empty() ? Remark("Nothing else was found.") : list;
  }

  std::string Structure() {
    const std::string list = ListOf(IsStructure, false);
    return list.empty() ? Remark("No floor, wall, ceiling or table top was found.") : list;
  }

  std::string Removed() {
    const std::string list = ListOf(IsRemoved, false);
    return list.empty() ? Remark("No object was seen to be removed.") : list;
  }

  std::string Trajectory() {
    return TrajectoryHtml(trajectory_, products_.mesh, scene_, {kWidth, kHeight});
  }

  std::string Times() { return StageTimesHtml(input_); }

  std::string Space() {
    return SpaceHtml(*space_, products_, scene_, options_.octree, {kWidth, kHeight});
  }

  std::string Scores() {
    return input_.scores_json.empty() ? Remark(input_.no_scores) : JsonTables(input_.scores_json);
  }

  std::string Processes() { return ProcessesHtml(input_); }

  std::string Versions() {
    HtmlTable table({});
    table.Add({"map made by", Escaped(loaded_.metadata.created_by)});
    table.Add({"report made by", Escaped(input_.version)});
    std::string html = table.Html() + "<h3>The map</h3>\n" +
                       JsonTables(StatisticsJson(loaded_.map, loaded_.metadata));
    if (!input_.run_json.empty())
      html += "<details><summary>report.json of the run</summary>" + JsonTables(input_.run_json) +
              "</details>\n";
    return html;
  }

  std::string Config() {
    if (loaded_.metadata.config.empty()) return Remark("The map does not say its config.");
    return "<p>With which the map was made:</p><pre>" + EscapedLines(loaded_.metadata.config) +
           "</pre>\n";
  }

  const LoadedMap& loaded_;
  const OutputOptions& options_;
  const ReportInput& input_;
  const std::function<bool(const std::string&)>& on_part_;
  const std::vector<CameraPose>& trajectory_;
  MapProducts products_;
  SceneBox scene_;
  Coloring coloring_ = Coloring::kInstance;
  std::optional<OccupancyMap> space_;
  std::vector<Mesh> meshes_;  // of the objects
  size_t thumbnails_ = 0;
  std::string surface_, about_;  // for the script
  std::vector<Part> parts_;
  bool is_stopped_ = false;  // by on_part_
};

}  // namespace

std::string ReportHtml(const LoadedMap& loaded, const OutputOptions& options,
                       const ReportInput& input,
                       const std::function<bool(const std::string&)>& on_part) {
  return Report(loaded, options, input, on_part).Html();
}

}  // namespace vismap
