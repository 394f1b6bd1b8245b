#include "exports/outputs.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <regex>
#include <set>
#include <system_error>

#include "base/class_names.h"
#include "base/file.h"
#include "exports/objects_json.h"
#include "exports/ply.h"
#include "map/far_parts.h"
#include "objects/camera_up.h"
#include "objects/map_mesh.h"
#include "objects/object_mesh.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

// Whether a file has the name of an object's mesh, see ObjectFileName, and is one that vismap
// wrote.
bool IsObjectMesh(const fs::path& path) {
  static const std::regex name("(instance_[0-9]+(_[A-Za-z0-9_-]*)?|segment_[0-9]+)\\.ply");
  std::error_code error;
  if (!std::regex_match(path.filename().string(), name)) return false;
  if (!fs::is_regular_file(fs::symlink_status(path, error))) return false;
  std::ifstream file(path, std::ios::binary);
  return StartsLikeOurPly(file);
}

// Removes the meshes of an earlier run, so that the folder has only the objects of this map. Files
// that vismap did not write stay.
Result<void> RemoveStaleMeshes(const fs::path& folder, const std::set<std::string>& current) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (!current.contains(name) && IsObjectMesh(entry.path())) fs::remove(entry.path(), error);
    if (error) break;
  }
  if (error) return Fail("cannot clean the folder " + folder.string() + ": " + error.message());
  return {};
}

// The id of the map and the names of the classes in the mesh.
PlyInfo InfoFor(const MapMetadata& metadata, const Mesh& mesh) {
  PlyInfo info;
  info.map_id = metadata.map_id;
  std::set<ClassId> classes;
  for (const MeshVertex& vertex : mesh.vertices) {
    if (vertex.class_id != ClassId::kUnknown) classes.insert(vertex.class_id);
  }
  for (const ClassId id : classes) info.class_names[id] = ClassName(id);
  return info;
}

// Removes the triangles with a vertex in one of these parts of the map, and such vertices.
void RemovePoints(const FarParts& far, Mesh* mesh) {
  if (far.empty()) return;
  constexpr uint32_t kRemoved = UINT32_MAX;
  std::vector<uint32_t> new_index(mesh->vertices.size(), kRemoved);
  std::vector<MeshVertex> kept;
  for (size_t i = 0; i < mesh->vertices.size(); ++i) {
    if (far.Contains(mesh->vertices[i].position_W.cast<double>())) continue;
    new_index[i] = static_cast<uint32_t>(kept.size());
    kept.push_back(mesh->vertices[i]);
  }
  mesh->vertices = std::move(kept);
  for (auto& triangle : mesh->triangles) {
    for (uint32_t& corner : triangle) corner = new_index[corner];
  }
  std::erase_if(mesh->triangles, [](const std::array<uint32_t, 3>& triangle) {
    return std::count(triangle.begin(), triangle.end(), uint32_t{UINT32_MAX}) > 0;
  });
}

std::string NameOf(const ObjectSummary& object) {
  return ObjectFileName(object,
                        object.class_id == ClassId::kUnknown ? "" : ClassName(object.class_id));
}

std::string PointsText(const Mesh& mesh) {
  std::string text;
  for (const MeshVertex& vertex : mesh.vertices) {
    const Eigen::Vector3f& p = vertex.position_W;
    const auto& [r, g, b] = vertex.color;
    std::array<char, 128> line{};
    std::snprintf(line.data(), line.size(), "%.5f %.5f %.5f %d %d %d\n", static_cast<double>(p.x()),
                  static_cast<double>(p.y()), static_cast<double>(p.z()), int{r}, int{g}, int{b});
    text += line.data();
  }
  return text;
}

}  // namespace

ObjectOptions ObjectOptionsFor(const MapMetadata& metadata, const OutputOptions& options) {
  ObjectOptions objects = options.objects;
  objects.cameras = UpOfCameras(metadata.trajectory);
  objects.up_W = options.up_W.value_or(objects.cameras.up_W);
  objects.up_is_guess = !options.up_W;
  return objects;
}

MapProducts MakeProducts(const SemanticMap& map, const MapMetadata& metadata,
                         const OutputOptions& options) {
  MapProducts products;
  products.mesh = ExtractMesh(map, options.meshing);
  RemovePoints(FarParts(metadata.trajectory), &products.mesh);
  products.objects =
      SummarizeObjects(map, products.mesh, ObjectOptionsFor(metadata, options), &products.up);
  ShowWholeObjects(products.objects, &products.mesh);
  return products;
}

OccupancyMap ClassifyNearParts(const SemanticMap& map, const MapMetadata& metadata,
                               const OccupancyOptions& options,
                               const std::optional<BlockRegion>& region) {
  std::vector<BlockIndex> blocks =
      region ? BlocksIn(map.voxels.blocks(), *region) : map.voxels.SortedIndices();
  if (const FarParts far(metadata.trajectory); !far.empty()) {
    std::erase_if(blocks, [&](const BlockIndex& index) {
      const Eigen::Vector3d corner(index.x, index.y, index.z);
      return far.Contains(corner * map.voxels.block_size());
    });
  }
  OccupancyMap occupancy(map.voxels.voxel_size());
  occupancy.Update(map, blocks, options);
  return occupancy;
}

Result<OctreeBytes> MakeOctree(const SemanticMap& map, const MapMetadata& metadata,
                               const OutputOptions& options, UnknownPolicy unknown) {
  OctreeOptions octree = options.octree;
  octree.unknown = unknown;
  return BuildOctree(ClassifyNearParts(map, metadata, options.free_space), octree);
}

std::string ObjectsText(const MapMetadata& metadata, const MapProducts& products) {
  return ObjectsJson(metadata.map_id, products.up, products.objects, ClassName);
}

Result<int> WriteObjectMeshes(const MapMetadata& metadata, const MapProducts& products,
                              const fs::path& folder) {
  if (const Result<void> made = CreateFolder(folder); !made) return tl::unexpected(made.error());
  const std::vector<Mesh> meshes = CutObjects(products.mesh, products.objects);
  std::set<std::string> written;
  for (size_t i = 0; i < meshes.size(); ++i) {
    const ObjectSummary& object = products.objects[i];
    if (meshes[i].triangles.empty() || (object.is_structure())) continue;
    const std::string name = NameOf(object) + ".ply";
    const Result<void> saved = WritePly(folder / name, meshes[i], InfoFor(metadata, meshes[i]));
    if (!saved) return tl::unexpected(saved.error());
    written.insert(name);
  }
  if (const Result<void> cleaned = RemoveStaleMeshes(folder, written); !cleaned)
    return tl::unexpected(cleaned.error());
  return static_cast<int>(written.size());
}

Result<std::vector<fs::path>> WriteSelectedObjects(const MapMetadata& metadata,
                                                   const MapProducts& products,
                                                   const fs::path& folder) {
  if (const Result<void> made = CreateFolder(folder); !made) return tl::unexpected(made.error());
  const std::vector<Mesh> meshes = CutObjects(products.mesh, products.objects);
  std::vector<fs::path> files;
  for (size_t i = 0; i < meshes.size(); ++i) {
    if (meshes[i].triangles.empty()) continue;
    const fs::path file = folder / NameOf(products.objects[i]);
    const auto mesh = WritePly(file.string() + ".ply", meshes[i], InfoFor(metadata, meshes[i]));
    if (!mesh) return tl::unexpected(mesh.error());
    const auto points = WriteFileAtomically(file.string() + ".xyz", PointsText(meshes[i]));
    if (!points) return tl::unexpected(points.error());
    files.insert(files.end(), {file.string() + ".ply", file.string() + ".xyz"});
  }
  return files;
}

Result<void> WriteMesh(const MapMetadata& metadata, const MapProducts& products,
                       const fs::path& path) {
  return WritePly(path, products.mesh, InfoFor(metadata, products.mesh));
}

}  // namespace vismap
