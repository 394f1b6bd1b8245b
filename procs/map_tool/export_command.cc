#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "base/file.h"
#include "exports/outputs.h"
#include "map_tool/commands.h"
#include "map_tool/live_map.h"
#include "map_tool/object_table.h"
#include "map_tool/selected_objects.h"
#include "map_tool/space_request.h"
#include "navigation/grid_files.h"
#include "objects/camera_up.h"

// The subcommand `export` of vismap-map.

namespace vismap {
namespace {

namespace fs = std::filesystem;

Outcome Wrote(const Result<void>& written, const fs::path& file) {
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  std::printf("%s\n", fs::absolute(file).c_str());
  return {};
}

/// Writes meshes and points of the selected objects.
Outcome ExportObjects(const MapToolArguments& arguments, const LoadedMap& loaded,
                      const ObjectQuery& query) {
  const auto products = SelectProducts(arguments, loaded, query);
  if (!products) return tl::unexpected(products.error());
  const auto files = WriteSelectedObjects(loaded.metadata, *products, arguments.out);
  if (!files) return ExitWith(ExitCode::kFailed, files.error().message);
  if (files->empty()) {
    return ExitWith(ExitCode::kFailed,
                    arguments.map + ": none of the selected objects has a surface in the map");
  }
  for (const fs::path& file : *files) std::printf("%s\n", fs::absolute(file).c_str());
  return {};
}

Outcome ExportOctree(const MapToolArguments& arguments, const LoadedMap& loaded,
                     UnknownPolicy unknown, const char* name) {
  const auto space = SpaceOf(arguments, loaded);
  if (!space) return tl::unexpected(space.error());
  OctreeOptions options = arguments.config.octree;
  options.unknown = unknown;
  const Result<OctreeBytes> octree = BuildOctree(*space, options);
  if (!octree) return ExitWith(ExitCode::kFailed, octree.error().message);
  const fs::path file = fs::path(arguments.out) / name;
  return Wrote(WriteOctree(file, *octree), file);
}

/// Writes one thing alone.
Outcome ExportOne(const MapToolArguments& arguments, const LoadedMap& loaded) {
  const fs::path folder = arguments.out;
  if (const auto made = CreateFolder(folder); !made)
    return ExitWith(ExitCode::kFailed, made.error().message);
  if (arguments.only == "octree")
    return ExportOctree(arguments, loaded, UnknownPolicy::kAbsent, "octree.bt");
  if (arguments.only == "octree-closed")
    return ExportOctree(arguments, loaded, UnknownPolicy::kOccupied, "octree.closed.bt");
  const MapProducts products = MakeProducts(loaded.map, loaded.metadata, arguments.config);
  if (arguments.only == "mesh")
    return Wrote(WriteMesh(loaded.metadata, products, folder / "mesh.ply"), folder / "mesh.ply");
  const fs::path file = folder / "objects.json";
  return Wrote(WriteFileAtomically(file, ObjectsText(loaded.metadata, products)), file);
}

Outcome ExportAll(const MapToolArguments& arguments, const LoadedMap& loaded) {
  const MapProducts products = MakeProducts(loaded.map, loaded.metadata, arguments.config);
  const auto written =
      WriteOutputs(loaded.map, loaded.metadata, products, arguments.config, arguments.out);
  if (!written) return ExitWith(ExitCode::kFailed, written.error().message);
  if (!written->empty()) LogWarning(*written);
  PrintObjects(ObjectsText(loaded.metadata, products), false);
  std::printf("map hash %s\nresults in %s\n", loaded.map_hash.c_str(),
              fs::absolute(arguments.out).c_str());
  return {};
}

std::vector<Eigen::Vector3d> PathOf(const MapMetadata& metadata) {
  std::vector<Eigen::Vector3d> path_W;
  for (const CameraPose& pose : metadata.trajectory) path_W.push_back(pose.T_W_C.translation());
  return path_W;
}

double SquareMeters(const GroundGrid& grid, CellState state) {
  const auto cells = std::count(grid.states.begin(), grid.states.end(), state);
  return static_cast<double>(cells) * grid.resolution_m * grid.resolution_m;
}

/// A grid counts heights along z, so that it makes sense only where z points upward.
Outcome CheckUpward(const MapToolArguments& arguments, const MapMetadata& metadata) {
  constexpr double kCosineOf20Degrees = 0.94;
  const CameraUp cameras = UpOfCameras(metadata.trajectory);
  const Eigen::Vector3d up_W = arguments.config.up_W.value_or(cameras.up_W);
  if (up_W.z() >= kCosineOf20Degrees) return {};
  const std::string reason = arguments.config.up_W ? "objects.up_W" : cameras.reason;
  return ExitWith(ExitCode::kFailed,
                  arguments.map +
                      ": a grid for wheels needs a map whose z axis points upward, but " +
                      DirectionText(up_W) + " does (" + reason +
                      "); map with poses in a level world, or say so with objects.up_W");
}

Outcome ExportGrid(const MapToolArguments& arguments, const LoadedMap& loaded) {
  if (const Outcome upward = CheckUpward(arguments, loaded.metadata); !upward) return upward;
  const auto space = SpaceOf(arguments, loaded);
  if (!space) return tl::unexpected(space.error());
  const auto grid = MakeGroundGrid(*space, arguments.config.ground_grid, PathOf(loaded.metadata));
  if (!grid) return ExitWith(ExitCode::kFailed, arguments.map + ": " + grid.error().message);
  const auto files = WriteGridFiles(*grid, arguments.grid);
  if (!files) return ExitWith(ExitCode::kFailed, arguments.map + ": " + files.error().message);
  std::printf("grid of %d x %d cells of %g m: %.1f m^2 free, %.1f m^2 occupied\n%s\n%s\n",
              grid->width, grid->height, grid->resolution_m, SquareMeters(*grid, CellState::kFree),
              SquareMeters(*grid, CellState::kOccupied), fs::absolute(files->image).c_str(),
              fs::absolute(files->yaml).c_str());
  return {};
}

/// Whether the options go together.
Outcome CheckTogether(const MapToolArguments& arguments, const ObjectQuery& query) {
  const auto refuse = [](const char* sentence) { return ExitWith(ExitCode::kUsage, sentence); };
  const bool folder = !arguments.out.empty();
  const bool octree_alone = arguments.only.starts_with("octree");
  if (!folder && arguments.grid.empty())
    return refuse("export: expected --out FOLDER, --grid WHERE, or both");
  if (!folder && (!query.all() || !arguments.only.empty()))
    return refuse("export: a selection needs --out FOLDER");
  if (!query.all() && !arguments.only.empty())
    return refuse("export: --only and a selection of objects exclude each other");
  if (!arguments.without.empty() && folder && !octree_alone) {
    return refuse(
        "export: --without is about free space only: with --out it needs --only octree or --only "
        "octree-closed");
  }
  return {};
}

}  // namespace

Outcome RunExport(const MapToolArguments& arguments, ProcessContext& context) {
  const Result<ObjectQuery> query = QueryOf(arguments);
  if (!query) return ExitWith(ExitCode::kUsage, query.error().message);
  if (const Outcome fit = CheckTogether(arguments, *query); !fit) return fit;
  const auto loaded = LoadMapOrLive(arguments, context);
  if (!loaded) return tl::unexpected(loaded.error());
  if (!arguments.grid.empty()) {
    if (const Outcome done = ExportGrid(arguments, *loaded); !done) return done;
  }
  if (arguments.out.empty()) return {};
  if (!query->all()) return ExportObjects(arguments, *loaded, *query);
  if (!arguments.only.empty()) return ExportOne(arguments, *loaded);
  return ExportAll(arguments, *loaded);
}

}  // namespace vismap
