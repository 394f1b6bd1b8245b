#include "pictures/report.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/class_names.h"
#include "base/format.h"
#include "exports/statistics.h"
#include "objects/object_mesh.h"
#include "pictures/html.h"
#include "pictures/octree_picture.h"
#include "pictures/report_parts.h"
#include "pictures/report_style.h"
#include "pictures/slice_picture.h"
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
constexpr double kRobotHeight = 0.5;  // of the slice above the floor [m]
constexpr double kElevation = 0.61;   // of the turntable [rad]

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
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto at = [&](uint32_t i) -> Vector3d {
      return mesh.vertices[i].position_W.cast<double>();
    };
    area += 0.5 * (at(b) - at(a)).cross(at(c) - at(a)).norm();
  }
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
  Mesh part;
  std::vector<uint32_t> index(mesh.vertices.size(), UINT32_MAX);
  for (std::array<uint32_t, 3> triangle : mesh.triangles) {
    if (std::any_of(triangle.begin(), triangle.end(), is_out)) continue;
    for (uint32_t& corner : triangle) {
      if (index[corner] == UINT32_MAX) {
        index[corner] = static_cast<uint32_t>(part.vertices.size());
        part.vertices.push_back(mesh.vertices[corner]);
      }
      corner = index[corner];
    }
    part.triangles.push_back(triangle);
  }
  return part.triangles.empty() ? mesh : part;
}

/// Makes the parts of a report one after the other.
class Report {
 public:
  Report(const LoadedMap& loaded, const OutputOptions& options, const ReportInput& input,
         const std::function<void(const std::string&)>& on_part)
      : loaded_(loaded),
        options_(options),
        input_(input),
        on_part_(on_part),
        trajectory_(loaded.metadata.trajectory) {}

  std::string Html() {
    on_part_("surface and objects");
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
    return Page();
  }

 private:
  void Add(const char* id, const char* title, std::string (Report::*make)()) {
    on_part_(title);
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

  std::set<CameraId> Cameras() const {
    std::set<CameraId> cameras;
    for (const CameraPose& pose : trajectory_) cameras.insert(pose.camera_id);
    return cameras;
  }

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
                             FormatCount(std::ssize(Cameras()), "camera")});
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
    return table.Html() + FindingsHtml(input_.run_json);
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
    return table.empty() ? "" : table.Html();
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

  std::vector<Vector3d> PathOf(CameraId camera) const {
    std::vector<Vector3d> path_W;
    for (const CameraPose& pose : trajectory_)
      if (pose.camera_id == camera) path_W.push_back(pose.T_W_C.translation());
    return path_W;
  }

  std::string Trajectory() {
    if (trajectory_.empty()) return Remark("The map has no trajectory.");
    const int rows = kHeight - kTitleRows - LegendRows(kHeight);
    const View view = TopDownView(scene_, kWidth, rows);
    Image<Rgb8> picture = RenderMesh(products_.mesh, view, Coloring::kSegment);
    for (Rgb8& pixel : picture.pixels()) pixel = Pale(pixel);
    Caption caption{"Where the cameras were, seen from above", {}, {}, view.scale};
    HtmlTable table({"camera", "frames", "way [m]"});
    for (const CameraId camera : Cameras()) {
      const std::vector<Vector3d> path_W = PathOf(camera);
      const Rgb8 color = StrongColor(static_cast<uint32_t>(camera) + 1);
      DrawPath(path_W, view, color, &picture);
      const std::string name = "camera " + std::to_string(static_cast<int>(camera));
      caption.legend.push_back({{color}, name});
      table.Add({name, FormatCount(std::ssize(path_W)), Digits(LengthOf(path_W), 2)});
    }
    caption.legend.push_back({{kInk}, "where each began"});
    return WebpFigure(WithCaption(picture, caption, kHeight), "Trajectory") + table.Html();
  }

  static Rgb8 Pale(Rgb8 color) {
    const int grey = (color.r + color.g + color.b) / 3;
    const auto pale = static_cast<uint8_t>(150 + grey * 100 / 255);
    return {pale, pale, pale};
  }

  static double LengthOf(const std::vector<Vector3d>& path_W) {
    double length = 0;
    for (size_t i = 1; i < path_W.size(); ++i) length += (path_W[i] - path_W[i - 1]).norm();
    return length;
  }

  static void DrawPath(const std::vector<Vector3d>& path_W, const View& view, Rgb8 color,
                       Image<Rgb8>* picture) {
    std::optional<Eigen::Vector2d> last;
    for (const Vector3d& p_W : path_W) {
      const auto pixel = ProjectToView(view, p_W);
      if (pixel && last) DrawLine(*last, *pixel, color, 2, picture);
      last = pixel;
    }
    if (path_W.empty()) return;
    if (const auto start = ProjectToView(view, path_W[0])) DrawDisc(*start, 5, kInk, picture);
  }

  std::string Times() { return StageTimesHtml(input_.run_json); }

  /// The axis of W that is nearest to up.
  int UpAxis() const {
    Eigen::Index axis = 0;
    products_.up.up_W.cwiseAbs().maxCoeff(&axis);
    return static_cast<int>(axis);
  }

  /// Where the slice is on this axis: above the floor in the middle of the map [m].
  double SlicePlace(int axis) const {
    const Vector3d& up_W = products_.up.up_W;
    const double rise = FloorHeight() + kRobotHeight - scene_.center_W.dot(up_W);
    return (scene_.center_W + rise * up_W)[axis];
  }

  /// The lowest floor along up, or the lowest surface [m].
  double FloorHeight() const {
    double lowest = scene_.center_W.dot(products_.up.up_W) - scene_.size.z() / 2;
    bool found = false;
    for (const ObjectSummary& object : products_.objects) {
      if (object.removed() || object.structure != StructureKind::kFloor) continue;
      const double height = object.plane.point_W.dot(products_.up.up_W);
      lowest = found ? std::min(lowest, height) : height;
      found = true;
    }
    return lowest;
  }

  std::string Space() {
    const auto known = space_->KnownCells();
    if (!known) return Remark("Nothing is known of the space of this map.");
    const int axis = UpAxis();
    SlicePictureOptions options;
    options.width = kWidth;
    options.height = kHeight;
    SliceQuestion question;
    question.axis = axis;
    question.at_m = SlicePlace(axis);
    question.cell_m = SliceCellFor(*space_, axis, options);
    const Result<Slice> slice = CutSlice(*space_, question);
    const std::string name = std::string(1, "xyz"[axis]) + " = " + MetresText(question.at_m);
    std::string html = Shares(*known);
    if (!slice) return html + Remark(slice.error().message);
    html += PngFigure(RenderSlice(*slice, question, "Slice at " + name, options),
                      "Free, occupied and unknown space " + Digits(kRobotHeight, 1) +
                          " m above the floor in the middle of the map, at " + Escaped(name));
    return html + OctreePicture();
  }

  std::string Shares(const OccupancyBox& known) const {
    int64_t free = 0, occupied = 0;
    space_->blocks().ForEach([&](BlockIndex, const BlockOccupancy& block) {
      const OccupancyPlanes planes = block.Planes();
      for (const uint64_t word : planes.free) free += std::popcount(word);
      for (const uint64_t word : planes.occupied) occupied += std::popcount(word);
    });
    const double all = static_cast<double>(known.max.x - known.min.x) *
                       static_cast<double>(known.max.y - known.min.y) *
                       static_cast<double>(known.max.z - known.min.z);
    const double cell = std::pow(space_->cell_size(), 3);
    HtmlTable table({"space", "volume [m&sup3;]", "share of the box around all that is known"});
    const auto add = [&](const char* state, double cells) {
      table.Add({state, Digits(cells * cell, 2), Escaped(FormatPercent(cells / all))});
    };
    add("free", static_cast<double>(free));
    add("occupied", static_cast<double>(occupied));
    add("unknown", all - static_cast<double>(free) - static_cast<double>(occupied));
    return table.Html();
  }

  std::string OctreePicture() const {
    const auto octree = BuildOctree(*space_, options_.octree);
    if (!octree) return Remark("There is no octree: " + octree.error().message);
    const auto leaves = ReadOctree(octree->bytes, "octree");
    if (!leaves) return Remark("There is no octree: " + leaves.error().message);
    const auto cubes = MakeLeafCubes(*leaves, {.up_W = products_.up.up_W});
    if (!cubes) return Remark("The octree is not drawn: " + cubes.error().message);
    const int rows = kHeight - kTitleRows - LegendRows(kHeight);
    const View view =
        BestPerspectiveView(cubes->mesh, FrameScene(cubes->mesh, products_.up.up_W), kWidth, rows);
    return WebpFigure(WithCaption(RenderMesh(cubes->mesh, view, Coloring::kRgb),
                                  CubesCaption(*cubes, "Octree"), kHeight),
                      "The octree that planners get");
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
  const std::function<void(const std::string&)>& on_part_;
  const std::vector<CameraPose>& trajectory_;
  MapProducts products_;
  SceneBox scene_;
  Coloring coloring_ = Coloring::kInstance;
  std::optional<OccupancyMap> space_;
  std::vector<Mesh> meshes_;  // of the objects
  size_t thumbnails_ = 0;
  std::string surface_, about_;  // for the script
  std::vector<Part> parts_;
};

}  // namespace

std::string ReportHtml(const LoadedMap& loaded, const OutputOptions& options,
                       const ReportInput& input,
                       const std::function<void(const std::string&)>& on_part) {
  return Report(loaded, options, input, on_part).Html();
}

}  // namespace vismap
