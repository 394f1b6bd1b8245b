#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "base/class_names.h"
#include "base/file.h"
#include "exports/color_octree.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "pictures/octree_picture.h"
#include "pictures/slice_picture.h"
#include "render/overview.h"
#include "render/paint.h"
#include "render/png.h"
#include "render/webp.h"

// The subcommand `render` of vismap-map.

namespace vismap {
namespace {

namespace fs = std::filesystem;
using Pictures = std::vector<Image<Rgb8>>;

constexpr double kTurntableElevation = 0.61;  // [rad], 35 degrees
constexpr int kTurnMs = 6000;                 // time of one turn in an animation
constexpr int kAnimationQuality = 80;

/// What is drawn as a mesh, and its caption.
struct Model {
  Mesh mesh;
  std::vector<ObjectSummary> objects;
  Coloring coloring = Coloring::kRgb;
  Caption caption;
  Eigen::Vector3d up_W = Eigen::Vector3d::UnitZ();
};

bool IsOctreeFile(const std::string& path) {
  const std::string ending = fs::path(path).extension();
  return ending == ".bt" || ending == ".ot";
}

tl::unexpected<ExitFailure> Refuse(const std::string& sentence) {
  return ExitWith(ExitCode::kUsage, "render: " + sentence);
}

std::string Number(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Whether the options go together.
Outcome CheckOptions(const MapToolArguments& arguments) {
  for (const auto& [name, value] :
       {std::pair{"--at", arguments.at}, std::pair{"--below", arguments.below}}) {
    if (value && !(std::abs(*value) <= 1e5))
      return Refuse(std::string(name) + ": expected -100000 to 100000 m, found " + Number(*value));
  }
  const std::string& view = arguments.view;
  const bool octree = view == "octree", slice = view == "slice";
  if (arguments.at && !slice) return Refuse("--at is for --view slice, found --view " + view);
  if (arguments.axis && !slice) return Refuse("--axis is for --view slice, found --view " + view);
  if (arguments.resolution_m > 0 && (!octree || IsOctreeFile(arguments.map)))
    return Refuse("--res is for --view octree of a map; expected no --res with " +
                  (octree ? "an octree file" : "--view " + view));
  if (slice && !arguments.coloring.empty())
    return Refuse("--color: a slice has colours of its own, found " + arguments.coloring);
  if (slice && arguments.below) return Refuse("--below: a slice is cut by --at alone");
  if (octree && (arguments.coloring == "instance" || arguments.coloring == "segment" ||
                 arguments.coloring == "seen"))
    return Refuse("--color: expected height, class or rgb for an octree, found " +
                  arguments.coloring);
  if (arguments.turntable && (slice || view == "top"))
    return Refuse("--turntable: expected --view perspective or octree, found --view " + view);
  if (IsOctreeFile(arguments.map) && !octree)
    return Refuse("MAP: an octree needs --view octree, found --view " + view);
  const std::string ending = fs::path(arguments.out).extension();
  if (ending == ".webp" && !arguments.turntable)
    return Refuse("--out: a .webp file is an animation and needs --turntable");
  return {};
}

Coloring ColoringOf(const std::string& name) {
  if (name == "class") return Coloring::kClass;
  if (name == "segment") return Coloring::kSegment;
  if (name == "rgb" || name == "height" || name == "seen") return Coloring::kRgb;
  return Coloring::kInstance;
}

Model SurfaceModel(const MapToolArguments& arguments, const LoadedMap& loaded) {
  MapProducts products = MakeProducts(loaded.map, loaded.metadata, arguments.config);
  OverviewOptions options;
  options.coloring = ColoringOf(arguments.coloring);
  if (arguments.below) CutAbove(products.up.up_W, *arguments.below, &products.mesh);
  if (arguments.coloring == "height")
    options.scale = PaintHeights(products.up.up_W, &products.mesh);
  if (arguments.coloring == "seen") options.scale = PaintSeen(&products.mesh);
  Caption caption = CaptionOf(products.objects, ClassName, loaded.metadata.map_id, options);
  return {std::move(products.mesh), std::move(products.objects), options.coloring,
          std::move(caption), products.up.up_W};
}

Result<OctreeLeaves> LeavesOfFile(const std::string& path) {
  const auto bytes = ReadFileBytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return ReadOctree(*bytes, path);
}

Result<OctreeLeaves> LeavesOfMap(const MapToolArguments& arguments, const LoadedMap& loaded) {
  OutputOptions options = arguments.config;
  if (arguments.resolution_m > 0) options.octree.resolution_m = arguments.resolution_m;
  auto octree = MakeOctree(loaded.map, loaded.metadata, options, UnknownPolicy::kAbsent);
  if (!octree) return Fail("--res: " + octree.error().message);
  if (arguments.coloring != "class" || octree->nodes == 0) {
    return ReadOctree(octree->bytes, arguments.map);
  }
  const auto colored = ColorOctree(octree->bytes, loaded.map);
  if (!colored) return tl::unexpected(colored.error());
  return ReadOctree(*colored, arguments.map);
}

tl::expected<Model, ExitFailure> OctreeModel(const MapToolArguments& arguments,
                                             const OctreeLeaves& leaves,
                                             const Eigen::Vector3d& up_W) {
  const bool file_colors = arguments.coloring == "rgb" || arguments.coloring == "class";
  if (file_colors && !leaves.colors && IsOctreeFile(arguments.map)) {
    return Refuse("--color " + arguments.coloring + ": " + arguments.map +
                  " has no colours; expected a ColorOcTree (.ot)");
  }
  Result<LeafCubes> cubes = MakeLeafCubes(leaves, {up_W, arguments.below, file_colors});
  if (!cubes) return ExitWith(ExitCode::kUsage, arguments.map + ": " + cubes.error().message);
  Caption caption = CubesCaption(*cubes, fs::path(arguments.map).filename());
  return Model{std::move(cubes->mesh), {}, Coloring::kRgb, std::move(caption), up_W};
}

tl::expected<Model, ExitFailure> ModelOf(const MapToolArguments& arguments,
                                         ProcessContext& context) {
  if (IsOctreeFile(arguments.map)) {
    const Result<OctreeLeaves> leaves = LeavesOfFile(arguments.map);
    if (!leaves) return ExitWith(ExitCode::kUnreadable, leaves.error().message);
    return OctreeModel(arguments, *leaves,
                       arguments.config.up_W.value_or(Eigen::Vector3d::UnitZ()));
  }
  const auto loaded = LoadMapOrLive(arguments, context);
  if (!loaded) return tl::unexpected(loaded.error());
  if (arguments.view != "octree") return SurfaceModel(arguments, *loaded);
  if (arguments.coloring == "rgb")
    return Refuse("--color: expected height or class for the octree of a map, found rgb");
  const Result<OctreeLeaves> leaves = LeavesOfMap(arguments, *loaded);
  if (!leaves) return ExitWith(ExitCode::kUsage, leaves.error().message);
  const MapProducts products = MakeProducts(loaded->map, loaded->metadata, arguments.config);
  auto model = OctreeModel(arguments, *leaves, products.up.up_W);
  if (!model) return model;
  model->caption.title = loaded->metadata.map_id + ": octree";
  if (arguments.coloring == "class") {
    const auto classes = MakeLegend(products.objects, Coloring::kClass, ClassName);
    model->caption.legend.insert(model->caption.legend.end(), classes.begin(), classes.end());
  }
  return model;
}

int PictureRows(const MapToolArguments& arguments) {
  return arguments.height - kTitleRows - LegendRows(arguments.height);
}

Image<Rgb8> Draw(const Model& model, const View& view, const MapToolArguments& arguments,
                 bool names) {
  Image<Rgb8> picture = RenderMesh(model.mesh, view, model.coloring);
  if (names) NameObjects(model.objects, ClassName, view, &picture);
  Caption caption = model.caption;
  if (view.orthographic) caption.pixels_per_metre = view.scale;
  return WithCaption(picture, caption, arguments.height);
}

Image<Rgb8> DrawOverview(const Model& model, const MapToolArguments& arguments) {
  OverviewOptions options;
  options.width = arguments.width;
  options.height = arguments.height;
  options.coloring = model.coloring;
  options.up_W = model.up_W;
  options.scale = model.caption.scale;
  return RenderMapOverview(model.mesh, model.objects, ClassName, model.caption.title, options);
}

Image<Rgb8> DrawModel(const Model& model, const MapToolArguments& arguments) {
  if (arguments.view == "overview") return DrawOverview(model, arguments);
  const SceneBox scene = FrameScene(model.mesh, model.up_W);
  const int rows = PictureRows(arguments);
  if (arguments.view == "top")
    return Draw(model, TopDownView(scene, arguments.width, rows), arguments, true);
  return Draw(model, BestPerspectiveView(model.mesh, scene, arguments.width, rows), arguments,
              arguments.coloring.empty() || arguments.coloring == "instance");
}

double MiddleOf(const OccupancyMap& space, int axis) {
  const auto known = space.KnownCells();
  if (!known) return 0;
  const VoxelIndex &low = known->min, &high = known->max;
  const int32_t sum = axis == 0 ? low.x + high.x : axis == 1 ? low.y + high.y : low.z + high.z;
  return 0.5 * sum * space.cell_size();
}

tl::expected<Image<Rgb8>, ExitFailure> DrawSlice(const MapToolArguments& arguments,
                                                 ProcessContext& context) {
  const auto loaded = LoadMapOrLive(arguments, context);
  if (!loaded) return tl::unexpected(loaded.error());
  const OccupancyMap space =
      ClassifyNearParts(loaded->map, loaded->metadata, arguments.config.free_space);
  SlicePictureOptions options;
  options.width = arguments.width;
  options.height = arguments.height;
  SliceQuestion question;
  const std::string axis = arguments.axis.value_or("z");
  question.axis = axis == "x" ? 0 : axis == "y" ? 1 : 2;
  question.at_m = arguments.at.value_or(MiddleOf(space, question.axis));
  question.cell_m = SliceCellFor(space, question.axis, options);
  const Result<Slice> slice = CutSlice(space, question);
  if (!slice) return ExitWith(ExitCode::kUsage, arguments.map + ": " + slice.error().message);
  const auto unknown = static_cast<uint8_t>(CellState::kUnknown);
  if (std::all_of(slice->states.begin(), slice->states.end(),
                  [&](uint8_t state) { return state == unknown; })) {
    return ExitWith(ExitCode::kFailed, arguments.map + ": nothing is known of the space at " +
                                           axis + " = " + MetresText(question.at_m));
  }
  return RenderSlice(
      *slice, question,
      loaded->metadata.map_id + ": slice at " + axis + " = " + MetresText(question.at_m), options);
}

Outcome WriteOne(const fs::path& path, const Image<Rgb8>& picture) {
  if (const Result<void> written = WritePng(path, picture); !written)
    return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("wrote the picture %s\n", fs::absolute(path).c_str());
  return {};
}

Outcome WriteAnimation(const MapToolArguments& arguments, const Model& model,
                       const std::vector<View>& views) {
  WebpAnimation animation(arguments.width, arguments.height,
                          std::max<int>(20, kTurnMs / static_cast<int>(views.size())),
                          kAnimationQuality);
  for (const View& view : views) animation.Add(Draw(model, view, arguments, false));
  if (const auto written = WriteFileAtomically(arguments.out, animation.Finish()); !written)
    return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("wrote an animation of %zu views to %s\n", views.size(),
              fs::absolute(arguments.out).c_str());
  return {};
}

/// The name of picture `i`: FOLDER/000.png, or NAME_000.png for NAME.png.
fs::path TurntableFile(const fs::path& out, size_t i) {
  char number[32];
  std::snprintf(number, sizeof number, "%03zu.png", i);
  if (out.extension() != ".png") return out / number;
  return out.parent_path() / (out.stem().string() + "_" + number);
}

Outcome WriteTurntable(const MapToolArguments& arguments, const Model& model) {
  const std::vector<View> views =
      TurntableViews(FrameScene(model.mesh, model.up_W), *arguments.turntable, kTurntableElevation,
                     arguments.width, PictureRows(arguments));
  const fs::path out = arguments.out;
  if (out.extension() == ".webp") return WriteAnimation(arguments, model, views);
  if (out.extension() != ".png") {
    if (const auto made = CreateFolder(out); !made)
      return ExitWith(ExitCode::kFailed, made.error().message);
  }
  for (size_t i = 0; i < views.size(); ++i) {
    const auto written = WritePng(TurntableFile(out, i), Draw(model, views[i], arguments, false));
    if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  }
  std::printf("wrote %zu pictures, %s to %s\n", views.size(),
              fs::absolute(TurntableFile(out, 0)).c_str(),
              TurntableFile(out, views.size() - 1).filename().c_str());
  return {};
}

}  // namespace

Outcome RunRender(const MapToolArguments& arguments, ProcessContext& context) {
  if (const Outcome fit = CheckOptions(arguments); !fit) return fit;
  if (arguments.view == "slice") {
    const auto picture = DrawSlice(arguments, context);
    if (!picture) return tl::unexpected(picture.error());
    return WriteOne(arguments.out, *picture);
  }
  const auto model = ModelOf(arguments, context);
  if (!model) return tl::unexpected(model.error());
  if (model->mesh.triangles.empty()) {
    return ExitWith(ExitCode::kFailed,
                    arguments.map + ": there is nothing to draw" +
                        (arguments.below ? " below " + MetresText(*arguments.below) : ""));
  }
  if (arguments.turntable) return WriteTurntable(arguments, *model);
  return WriteOne(arguments.out, DrawModel(*model, arguments));
}

}  // namespace vismap
