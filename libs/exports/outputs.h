#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "freespace/octree.h"
#include "mapfile/map_file.h"
#include "objects/objects.h"

namespace vismap {

struct OutputOptions {
  MeshingOptions meshing;
  ObjectOptions objects;  ///< its up_W is taken from the trajectory unless `up_W` is set
  std::optional<Eigen::Vector3d> up_W;
  OccupancyOptions occupancy;
  double octree_resolution = 0;  ///< [m]; 0 = see OctreeOptions
  double octree_free_fraction = 1.0;
};

/// What people look at: derived from a map, nothing new in it.
struct MapProducts {
  Mesh mesh;
  std::vector<ObjectSummary> objects;
};

/// Mesh and objects of a map.
MapProducts MakeProducts(const SemanticMap& map, const MapMetadata& metadata,
                         const OutputOptions& options);

/// The options of the objects with up_W filled in.
ObjectOptions ObjectOptionsFor(const MapMetadata& metadata, const OutputOptions& options);

/// The octree of a map, unknown space left out or, within the bounds, written occupied.
Result<OctreeBytes> MakeOctree(const SemanticMap& map, const OutputOptions& options,
                               UnknownPolicy unknown);

/// objects.json of the products.
std::string ObjectsText(const MapMetadata& metadata, const MapProducts& products);

/// Writes one PLY per object and discovered segment (structure left out) into `folder`/, replacing
/// those of an earlier run.
Result<int> WriteObjectMeshes(const MapMetadata& metadata, const MapProducts& products,
                              const std::filesystem::path& folder);

/// Mesh and points of the objects of the products that have a surface, as NAME.ply (see ply.h) and
/// NAME.xyz (a line "x y z r g b" per vertex, metres in W) in `folder`, which is created. Other
/// files there stay. Returns the files.
Result<std::vector<std::filesystem::path>> WriteSelectedObjects(
    const MapMetadata& metadata, const MapProducts& products, const std::filesystem::path& folder);

/// mesh.ply of the products.
Result<void> WriteMesh(const MapMetadata& metadata, const MapProducts& products,
                       const std::filesystem::path& path);

/// Everything into `folder`, which is created: mesh.ply, objects.json, objects/*.ply, map.vismap,
/// octree.bt, octree.closed.bt, map.png. Returns the saved map's facts.
Result<SaveInfo> WriteOutputs(const SemanticMap& map, const MapMetadata& metadata,
                              const MapProducts& products, const OutputOptions& options,
                              const std::filesystem::path& folder);

}  // namespace vismap
