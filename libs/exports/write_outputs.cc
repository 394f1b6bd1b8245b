#include "base/class_names.h"
#include "base/file.h"
#include "exports/outputs.h"
#include "render/overview.h"
#include "render/png.h"

// WriteOutputs has a file of its own, so that programs that do not call it need not load the
// libraries for pictures.

namespace vismap {

Result<SaveInfo> WriteOutputs(const SemanticMap& map, const MapMetadata& metadata,
                              const MapProducts& products, const OutputOptions& options,
                              const std::filesystem::path& folder) {
  if (const Result<void> made = CreateFolder(folder); !made) return tl::unexpected(made.error());
  Result<SaveInfo> saved = SaveMap(map, metadata, folder / "map.vismap");
  if (!saved) return saved;
  if (const auto done = WriteMesh(metadata, products, folder / "mesh.ply"); !done)
    return tl::unexpected(done.error());
  if (const auto done =
          WriteFileAtomically(folder / "objects.json", ObjectsText(metadata, products));
      !done) {
    return tl::unexpected(done.error());
  }
  if (const auto done = WriteObjectMeshes(metadata, products, folder / "objects"); !done) {
    return tl::unexpected(done.error());
  }
  for (const UnknownPolicy unknown : {UnknownPolicy::kAbsent, UnknownPolicy::kOccupied}) {
    const Result<OctreeBytes> octree = MakeOctree(map, options, unknown);
    if (!octree) return tl::unexpected(octree.error());
    const char* name = unknown == UnknownPolicy::kAbsent ? "octree.bt" : "octree.closed.bt";
    if (const auto done = WriteOctree(folder / name, *octree); !done)
      return tl::unexpected(done.error());
  }
  OverviewOptions overview;
  overview.up_W = ObjectOptionsFor(metadata, options).up_W;
  const Image<Rgb8> picture =
      RenderMapOverview(products.mesh, products.objects, ClassName, metadata.map_id, overview);
  if (const auto done = WritePng(folder / "map.png", picture); !done)
    return tl::unexpected(done.error());
  return saved;
}

}  // namespace vismap
