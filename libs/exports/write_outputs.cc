#include <system_error>

#include "base/class_names.h"
#include "base/file.h"
#include "exports/outputs.h"
#include "render/overview.h"
#include "render/png.h"

// WriteOutputs has a file of its own, so that programs that do not call it need not load the
// libraries for pictures.

namespace vismap {
namespace {

namespace fs = std::filesystem;

/// Writes what can be written and remembers what cannot. An older file at the place of one that
/// cannot be written is removed, since it belongs to another map than its neighbours.
class Outputs {
 public:
  void Check(const fs::path& file, const Result<void>& written) {
    if (written) return;
    const std::string& problem = written.error().message;
    if (problems_.find(problem) == std::string::npos)
      problems_ += (problems_.empty() ? "" : "; ") + problem;
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) fs::remove(file, ignored);
  }
  const std::string& problems() const { return problems_; }

 private:
  std::string problems_;
};

/// Writes both octrees. Returns why there are none when nothing is known, else "".
std::string WriteOctrees(const SemanticMap& map, const MapMetadata& metadata,
                         const OutputOptions& options, const fs::path& folder, Outputs* outputs) {
  std::string none;
  for (const auto& [name, unknown] : {std::pair{"octree.bt", UnknownPolicy::kAbsent},
                                      std::pair{"octree.closed.bt", UnknownPolicy::kOccupied}}) {
    const Result<OctreeBytes> octree = MakeOctree(map, metadata, options, unknown);
    const Result<void> written =
        octree ? WriteOctree(folder / name, *octree) : tl::unexpected(octree.error());
    if (octree && octree->nodes == 0) {
      none = written.error().message;
    } else {
      outputs->Check(folder / name, written);
    }
  }
  return none;
}

Result<void> WritePicture(const MapMetadata& metadata, const MapProducts& products,
                          const fs::path& file) {
  OverviewOptions overview;
  overview.up_W = products.up.up_W;
  return WritePng(file, RenderMapOverview(products.mesh, products.objects, ClassName,
                                          metadata.map_id, overview));
}

/// Removes what runs that were killed while writing have left.
void RemoveStaleOutputs(const fs::path& folder) {
  for (const char* name : {"map.vismap", "mesh.ply", "objects.json", "octree.bt",
                           "octree.closed.bt", "map.png", "report.json"})
    RemoveStaleTemporaries(folder / name);
  RemoveStaleTemporariesIn(folder / "objects", ".ply");
}

}  // namespace

Result<std::string> WriteOutputs(const SemanticMap& map, const MapMetadata& metadata,
                                 const MapProducts& products, const OutputOptions& options,
                                 const fs::path& folder) {
  if (const Result<void> made = CreateFolder(folder); !made) return tl::unexpected(made.error());
  RemoveStaleOutputs(folder);
  std::error_code ignored;
  const fs::path map_file = folder / "map.vismap";
  const bool replaces_map = fs::exists(map_file, ignored);
  const Result<SaveInfo> saved = SaveMap(map, metadata, map_file);
  // The older map stays, with all that belongs to it.
  if (!saved && replaces_map) return tl::unexpected(saved.error());
  Outputs outputs;
  if (!saved) outputs.Check(map_file, tl::unexpected(saved.error()));
  outputs.Check(folder / "mesh.ply", WriteMesh(metadata, products, folder / "mesh.ply"));
  outputs.Check(folder / "objects.json",
                WriteFileAtomically(folder / "objects.json", ObjectsText(metadata, products)));
  const Result<int> objects = WriteObjectMeshes(metadata, products, folder / "objects");
  if (!objects) outputs.Check(folder / "objects", tl::unexpected(objects.error()));
  std::string without_octrees = WriteOctrees(map, metadata, options, folder, &outputs);
  outputs.Check(folder / "map.png", WritePicture(metadata, products, folder / "map.png"));
  if (!outputs.problems().empty()) return Fail(outputs.problems());
  return without_octrees;
}

}  // namespace vismap
