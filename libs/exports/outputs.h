#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "freespace/block_region.h"
#include "freespace/octree.h"
#include "mapfile/map_file.h"
#include "objects/objects.h"

namespace vismap {

/// How the outputs of a map are made.
struct OutputOptions {
  MeshingOptions meshing;
  ObjectOptions objects;  ///< its up_W, up_is_guess and cameras are replaced, see ObjectOptionsFor
  /// Upward direction in W, unit length; not set = estimated from the trajectory.
  std::optional<Eigen::Vector3d> up_W;
  OccupancyOptions free_space;
  OctreeOptions octree;
};

/// The mesh and the objects of a map. Both are computed from the map alone.
struct MapProducts {
  Mesh mesh;
  std::vector<ObjectSummary> objects;
  UpDirection up;  ///< of the boxes of the objects
};

/// Computes the mesh and the objects of a map, without its FarParts.
MapProducts MakeProducts(const SemanticMap& map, const MapMetadata& metadata,
                         const OutputOptions& options);

/// options.objects with the upward direction: options.up_W, or, if that is not set, a guess from
/// the trajectory (UpOfCameras), which the map may correct.
ObjectOptions ObjectOptionsFor(const MapMetadata& metadata, const OutputOptions& options);

/// The free and occupied space of a map, or of the blocks of a region, without its FarParts.
OccupancyMap ClassifyNearParts(const SemanticMap& map, const MapMetadata& metadata,
                               const OccupancyOptions& options,
                               const std::optional<BlockRegion>& region = std::nullopt);

/// The octree of a map, without its FarParts. `unknown` replaces that of the options. Fails on what
/// BuildOctree fails on.
Result<OctreeBytes> MakeOctree(const SemanticMap& map, const MapMetadata& metadata,
                               const OutputOptions& options, UnknownPolicy unknown);

/// The text of objects.json.
std::string ObjectsText(const MapMetadata& metadata, const MapProducts& products);

/// Writes one PLY file per object that has a surface and is not structure into `folder`, which is
/// created. Removes the object meshes of an earlier run, and no other file. Returns the number of
/// files. Fails with the name of a file or folder that cannot be written.
Result<int> WriteObjectMeshes(const MapMetadata& metadata, const MapProducts& products,
                              const std::filesystem::path& folder);

/// Writes every object that has a surface into `folder`, which is created: its mesh as NAME.ply
/// (see ply.h) and its vertices as NAME.xyz (one line "x y z r g b" per vertex, metres in W). Other
/// files in the folder stay. Returns the paths of the files written.
Result<std::vector<std::filesystem::path>> WriteSelectedObjects(
    const MapMetadata& metadata, const MapProducts& products, const std::filesystem::path& folder);

/// Writes the mesh of the products as PLY to `path`.
Result<void> WriteMesh(const MapMetadata& metadata, const MapProducts& products,
                       const std::filesystem::path& path);

/// Writes all outputs of a map into `folder`, which is created: map.vismap, mesh.ply, objects.json,
/// objects/*.ply, octree.bt (raw), octree.closed.bt (closed, see UnknownPolicy) and map.png. A map
/// in which nothing is known has no octrees (see WriteOctree); then the result is a sentence that
/// says so, else "". Fails with all that cannot be made or written; the other files are written
/// then. No older file stands beside new ones. Only when an older map.vismap cannot be replaced,
/// everything stays as it was.
Result<std::string> WriteOutputs(const SemanticMap& map, const MapMetadata& metadata,
                                 const MapProducts& products, const OutputOptions& options,
                                 const std::filesystem::path& folder);

}  // namespace vismap
