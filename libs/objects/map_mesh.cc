#include "objects/map_mesh.h"

#include "objects/contacts.h"
#include "objects/islands.h"
#include "objects/read_out.h"

namespace vismap {

Mesh ExtractMesh(const SemanticMap& map, const MeshingOptions& options) {
  Mesh mesh = ExtractSurface(map, options);
  const auto read_out = [&] {
    ApplyReadOut(ReadLabels(map.labels, VerticesPerLabel(mesh)), &mesh);
  };
  read_out();
  if (options.island_max_share > 0) {
    AbsorbIslands(options, &mesh);
    read_out();
  }
  if (options.contact_voxels > 0) {
    AbsorbContacts(options.contact_voxels * map.voxels.voxel_size(), &mesh);
    read_out();
  }
  return mesh;
}

}  // namespace vismap
